% octave-cli octave.m SCENE LIMIT LABEL FILE...: the model of each network (programs/network.cpp), sizes
% ascending, in all ways that Octave and its control package have, and the package's response of the
% model at 100 frequencies; one CSV row each on stdout. A way
% is left out where, by the growth of the last two sizes, it would take longer than LIMIT seconds.
% The error is that of [A B; C D] V against titop's, per row over the row's magnitude.
1;

% --- ways: each takes the network and returns A, B, C, D -------------------------------------

% blocks with names for all signals, and the interconnection as one more static system
function [a, b, c, d] = by_names (s)
  number = @(letter, n) arrayfun (@(i) sprintf ("%s%d", letter, i), (1:n)', "uniformoutput", false);
  u = number ("u", columns (s.B)); y = number ("y", rows (s.C));
  w = number ("w", columns (s.E)); z = number ("z", rows (s.F));
  parts = cell (1, numel (s.parts));
  for i = 1 : numel (s.parts)
    p = s.parts{i};
    parts{i} = ss (p.A, p.B, p.C, p.D, "inname", u(p.u), "outname", y(p.y));
  end
  wires = ss (full ([s.K, s.E; s.F, s.G]), "inname", [y; w], "outname", [u; z]);
  [a, b, c, d] = ssdata (connect (parts{:}, wires, w, z));
end

% append the blocks, then close all loops by the interconnection matrix
function [a, b, c, d] = by_append (s)
  parts = cellfun (@(p) ss (p.A, p.B, p.C, p.D), s.parts, "uniformoutput", false);
  [a, b, c, d] = connected (s, append (parts{:}));
end

% the blocks as one block-diagonal system from the start
function [a, b, c, d] = by_mconnect (s)
  [a, b, c, d] = connected (s, ss (full (s.A), full (s.B), full (s.C), full (s.D)));
end

function [a, b, c, d] = connected (s, blocks)
  [a, b, c, d] = ssdata (mconnect (blocks, full (s.K)));
  d = s.F * d * s.E + s.G;
  b = b * s.E;
  c = s.F * c;
end

% the same by linear fractional transformation
function [a, b, c, d] = by_lft (s)
  blocks = ss (full (s.A), full (s.B), full (s.C), full (s.D));
  wires = ss (full ([s.G, s.F; s.E, s.K]));
  [a, b, c, d] = ssdata (lft (wires, blocks));
end

% Octave's own matrices: one dense solve
function [a, b, c, d] = by_hand (s)
  y = (eye (rows (s.C)) - full (s.D * s.K)) \ full ([s.C, s.D * s.E]);
  [a, b, c, d] = closed (s, s.K * y, y);
end

% the same with sparse matrices, which the control package has not
function [a, b, c, d] = by_sparse (s)
  ny = rows (s.C); nu = columns (s.B); n = rows (s.A);
  loop = [speye(ny), -s.D; -s.K, speye(nu)];
  v = loop \ [full(s.C), zeros(ny, columns (s.E)); zeros(nu, n), full(s.E)];
  y = v(1:ny, :);
  [a, b, c, d] = closed (s, v(ny+1:end, :), y, 0);
end

function [a, b, c, d] = closed (s, u, y, by = 1)
  n = rows (s.A);
  a = s.A + s.B * u(:, 1:n);
  b = s.B * (u(:, n+1:end) + by * s.E);
  c = s.F * y(:, 1:n);
  d = s.F * y(:, n+1:end) + s.G;
end

% --- timing -----------------------------------------------------------------------------------

% the blocks one by one, as a user has them
function s = network (file)
  s = load (file);
  x = u = y = 0;
  for i = 1 : rows (s.blocks)
    ix = x + (1:s.blocks(i,1)); iu = u + (1:s.blocks(i,2)); iy = y + (1:s.blocks(i,3));
    s.parts{i} = struct ("A", full (s.A(ix,ix)), "B", full (s.B(ix,iu)), "C", full (s.C(iy,ix)), ...
                         "D", full (s.D(iy,iu)), "u", iu, "y", iy);
    x += s.blocks(i,1); u += s.blocks(i,2); y += s.blocks(i,3);
  end
end

% fastest of at least two runs, or one of more than 3 s; `result` is the last one's
function [seconds, result] = fastest (way, outputs)
  seconds = Inf; total = 0; runs = 0; result = cell (1, outputs);
  while (runs < 2 && total < 3) || (total < 0.5 && runs < 1000)
    t = tic (); [result{:}] = way (); t = toc (t);
    seconds = min (seconds, t); total += t; ++runs;
  end
end

function [seconds, err] = timed (way, s)
  [seconds, result] = fastest (@() way (s), 4);
  [a, b, c, d] = result{:};
  if rows (a) != rows (s.A)
    err = Inf;  % a descriptor model, or states lost
    return;
  end
  M = [a, b; c, d];
  err = full (max (max (abs (M * s.V - s.MV), [], 2) ./ max (max (abs (M), [], 2), realmin)));
end

% the response of the model at all frequencies; the error is over the largest of its input's column
function [seconds, err] = timed_response (s)
  [a, b, c, d] = by_hand (s);
  model = ss (a, b, c, d);
  [seconds, result] = fastest (@() freqresp (model, s.w), 1);
  h = reshape (permute (result{1}, [1, 3, 2]), [], columns (d));
  err = max (max (abs (h - complex (s.H_re, s.H_im))) ./ max (abs (h)));
end

pkg load control
warning ("off", "all");
list = argv ();
scene = list{1}; limit = str2double (list{2}); label = list{3};  % which BLAS
ways = {"compile", "names", @(s) timed(@by_names, s); "compile", "append", @(s) timed(@by_append, s);
        "compile", "mconnect", @(s) timed(@by_mconnect, s); "compile", "lft", @(s) timed(@by_lft, s);
        "compile", "dense matrices", @(s) timed(@by_hand, s);
        "compile", "sparse matrices", @(s) timed(@by_sparse, s); "sweep", "freqresp", @timed_response};
last = [zeros(rows (ways), 2), 1.5 * ones(rows (ways), 1)];  % n, seconds, exponent
for f = 4 : numel (list)
  s = network (list{f});
  for k = 1 : rows (ways)
    note = "";
    exponent = min (3, max (1, last(k,3) + 0.5));
    if last(k,1) && last(k,2) * (s.n / last(k,1)) ^ exponent > limit
      printf ("%s,%s,%d,Octave %s%s,,,given up\n", ways{k,1}, scene, s.n, ways{k,2}, label);
      continue;
    end
    try
      [seconds, err] = ways{k,3} (s);
      if ! (err <= 1e-6)
        note = "disagrees";
      end
      if last(k,1)
        last(k,3) = log (seconds / last(k,2)) / log (s.n / last(k,1));
      end
      last(k,1:2) = [s.n, seconds];
      printf ("%s,%s,%d,Octave %s%s,%.4g,%.2g,%s\n", ways{k,1}, scene, s.n, ways{k,2}, label, ...
              seconds, err, note);
    catch e
      printf ("%s,%s,%d,Octave %s%s,,,%s\n", ways{k,1}, scene, s.n, ways{k,2}, label, ...
              strrep (e.message, ",", ";"));
    end
    fflush (stdout);
  end
end
