% octave-cli connect.m FOLDER ANSWERS: what Octave's control package makes of every scene that
% corpus_wiring has written to FOLDER. Each block is inverted where the wiring drives its outputs,
% then `connect` joins all by name. One line per scene: number, verdict, largest error of the
% transfer, order, order after minreal, the right order (-1: a planted
% mistake), largest real part of its poles, message.
1;

% Swaps the inputs and outputs of these rows: [u_k, y_k] <- [y_k, u_k].
function p = inverted (p)
  k = p.swap;
  if isempty (k) return; end
  X = p.D(k,k);
  if rcond (X) < eps error ("the direct term of an inverted channel is singular"); end
  l = setdiff (1:columns (p.D), k);  % other inputs
  m = setdiff (1:rows (p.D), k);     % other outputs
  C = p.C; D = p.D; B = p.B;
  p.A = p.A - B(:,k) * (X \ C(k,:));
  p.B(:,k) = B(:,k) / X;
  p.B(:,l) = B(:,l) - B(:,k) * (X \ D(k,l));
  p.C(k,:) = -(X \ C(k,:));
  p.C(m,:) = C(m,:) - D(m,k) * (X \ C(k,:));
  p.D(k,k) = inv (X);
  p.D(k,l) = -(X \ D(k,l));
  p.D(m,k) = D(m,k) / X;
  p.D(m,l) = D(m,l) - D(m,k) * (X \ D(k,l));
end

function sys = joined (s)
  number = @(letter, n) arrayfun (@(i) sprintf ("%s%d", letter, i), (1:n)', "uniformoutput", false);
  nq = rows (s.integrals); nu = rows (s.wires); nw = s.externals;
  ny = columns (s.wires) - nw - nq;
  u = number ("u", nu); y = number ("y", ny); w = number ("w", nw); z = number ("z", rows (s.outputs));
  v = number ("v", nq); q = number ("q", nq);
  parts = {}; iu = 0; iy = 0;
  for i = 1 : numel (s.parts)
    p = inverted (s.parts{i});
    parts{end+1} = ss (p.A, p.B, p.C, p.D, "inname", u(iu + (1:columns (p.D))), ...
                       "outname", y(iy + (1:rows (p.D))));
    iu += columns (p.D); iy += rows (p.D);
  end
  for i = 1 : nq
    parts{end+1} = ss ([0, 1; 0, 0], [0; 1], [1, 0], 0, "inname", v(i), "outname", q(i));
  end
  K = [s.wires; s.outputs; zeros(nq, columns (s.wires))];
  if nq > 0 K(nu + rows (s.outputs) + (1:nq), 1:ny+nw) = s.integrals; end
  wires = ss (K, "inname", [y; w; q], "outname", [u; z; v]);
  sys = connect (parts{:}, wires, w, z);
end

% Worst entry over all points, relative to the largest entries of its row and column at that point.
function worst = transfer_error (a, b, c, d, points)
  worst = 0;
  for k = 1 : numel (points)
    s = complex (points(k).s(1), points(k).s(2));
    G = c * ((s * eye (rows (a)) - a) \ b) + d;
    E = reshape (points(k).G, [size(G), 2]);
    E = E(:,:,1) + 1i * E(:,:,2);
    scale = sqrt (max (abs (E), [], 2)) * sqrt (max (abs (E), [], 1));
    off = abs (G - E);
    off(off <= 1e-12 * max (abs (E(:)))) = 0;  % 0 by nature
    err = off ./ scale; err(off == 0) = 0;
    worst = max ([worst; err(:)]);
    if any (isnan (off(:))) worst = Inf; end
  end
end

pkg load control
warning ("off", "all");
folder = argv (){1}; answers = argv (){2};
files = sort (glob (fullfile (folder, "s*.m")));
for f = 1 : numel (files)
  [~, name] = fileparts (files{f});
  name = name(2:end);
  answer = jsondecode (fileread (fullfile (answers, [name, ".json"])));
  mistaken = isfield (answer, "refused");
  order = err = least = fastest = NaN; right = -1; note = "";
  if ! mistaken right = answer.order; end
  tic ();
  try
    source (files{f});
    [a, b, c, d] = ssdata (joined (s));
    order = rows (a);
    fastest = max ([-Inf; real(eig (a))]);
    if mistaken
      verdict = "answered"; note = answer.refused.code;
    else
      err = transfer_error (a, b, c, d, answer.transfer);
      least = rows (ssdata (minreal (ss (a, b, c, d))));
      verdict = "wrong";
      if err <= 1e-6 verdict = "right"; end
    end
  catch e
    verdict = "refused"; note = strtok (e.message, "\n");
    if mistaken note = [answer.refused.code, ": ", note]; end
  end
  printf ("%s\t%s\t%.2g\t%g\t%g\t%d\t%.2g\t%.2f\t%s\n", name, verdict, err, order, least, right, ...
          fastest, toc (), note);
  fflush (stdout);
end
