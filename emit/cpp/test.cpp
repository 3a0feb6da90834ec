#include <fmt/format.h>

#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <titop/emit/cpp/test.hpp>
#include <titop/emit/cpp/test_source.hpp>
#include <titop/emit/text/literals.hpp>
#include <titop/graph/linalg/eigen.hpp>

namespace titop::emit {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

using Complex = std::complex<double>;

/// Least tolerances, for rounding on another machine: of a transfer or a trajectory, of a pole, of
/// a series of up to 1e9 multiplications.
constexpr double kLeast = 1e-11, kLeastOfPole = 1e-9, kLeastOfSeries = 1e-8;
/// Largest tolerance: a wrong sixth digit must fail.
constexpr double kTooWide = 1e-6;

/// Ten times the measured error, within these limits.
std::string tolerance(double least, double measured) {
  return fmt::format("{:.1e}", std::clamp(10 * measured, least, kTooWide));
}

/// The comment that replaces a check for which double is not accurate enough.
std::string omitted(const char* subject, double measured) {
  if (!std::isfinite(measured))
    return fmt::format("\n// {}: not checked. In double the matrices do not give it at all.\n",
                       subject);
  return fmt::format(
      "\n// {}: not checked. The matrices give it within {:.1e} only, too wide for a proof.\n",
      subject, measured);
}

std::string pair(double re, double im) { return fmt::format("{{{}, {}}}", number(re), number(im)); }

/// Complex values by columns, as an initializer.
std::string values(const MatrixXcd& G) {
  std::vector<std::string> items;
  for (Index j = 0; j < G.cols(); ++j)
    for (Index i = 0; i < G.rows(); ++i) items.push_back(pair(G(i, j).real(), G(i, j).imag()));
  return list(items, 6);
}

std::string indices(const std::vector<Index>& list) {
  std::vector<std::string> items;
  for (const Index i : list) items.push_back(std::to_string(i));
  return emit::list(items, 6);
}

/// s - A as the test factors it (kHead).
struct TestedResolvent {
  explicit TestedResolvent(const MatrixXd& A, Complex s)
      : R(s * MatrixXcd::Identity(A.rows(), A.rows()) - A),
        scale(R.cwiseAbs().rowwise().maxCoeff().cwiseInverse().cast<Complex>()),
        lu(scale.asDiagonal() * R) {}
  MatrixXcd solve(const MatrixXcd& b) const { return lu.solve(scale.asDiagonal() * b); }
  MatrixXcd refined(const MatrixXcd& b) const {
    const MatrixXcd x = solve(b);
    return x + solve(b - R * x);
  }

  MatrixXcd R;
  Eigen::VectorXcd scale;
  Eigen::PartialPivLU<MatrixXcd> lu;
};

/// The difference that the test will find at s, where it solves without the model's equilibration.
TransferDifference tested_difference(const ModelForm& form, Complex s, const MatrixXcd& exact,
                                     const Points& points) {
  const MatrixXcd B = form.B.cast<Complex>();
  return difference(form, form.A.rows() > 0 ? TestedResolvent(form.A, s).refined(B) : B, exact,
                    points);
}

/// Points that the test compares: a file of some megabytes is still compiled in seconds.
std::vector<std::size_t> compared(const Points& points) {
  const auto entries = static_cast<std::size_t>(points.exact[0].size());
  if (points.s.size() == 1) return {0};
  const std::size_t count = std::clamp<std::size_t>(40000 / entries, 2, points.s.size());
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < count; ++i) chosen.push_back(i * (points.s.size() - 1) / (count - 1));
  return chosen;
}

std::string transfer_test(const Naming& names, const ModelForm& form, const Points& points) {
  TransferDifference worst{form.error, kLeast};
  std::string checks;
  for (const std::size_t k : compared(points)) {
    const TransferDifference here = tested_difference(form, points.s[k], points.exact[k], points);
    worst.worst = std::max(worst.worst, here.worst);
    worst.rounding = std::max(worst.rounding, here.rounding);
    checks += fmt::format(
        "  {{\n    static const double expected[][2] = {};\n"
        "    CHECK(transfer_error({}, expected) <= tolerance);\n  }}\n",
        values(points.exact[k]), pair(points.s[k].real(), points.s[k].imag()));
  }
  const std::string shared = filled(kResponse, {{"SILENT_OUTPUTS", indices(points.silent_outputs)},
                                                {"SILENT_INPUTS", indices(points.silent_inputs)}});
  if (!is_provable(worst.worst)) return shared + omitted("transfer", worst.worst);
  return shared + filled(kTransfer, {{"NAME", names.name},
                                     {"TOLERANCE", tolerance(worst.rounding, worst.worst)},
                                     {"CHECKS", checks}});
}

std::string static_gain_test(const Naming& names, const ModelForm& form, const Expected& expected) {
  const MatrixXcd exact = expected.static_gain->cast<Complex>();
  const Points rest = at_rest(expected.points, *expected.static_gain);
  const TransferDifference here = tested_difference(form, 0, exact, rest);
  const double worst = std::max(form.static_error, here.worst);
  if (!is_provable(worst)) return omitted("static gain", worst);
  return filled(kStaticGain, {{"NAME", names.name},
                              {"VALUES", values(exact)},
                              {"SILENT_OUTPUTS", indices(rest.silent_outputs)},
                              {"SILENT_INPUTS", indices(rest.silent_inputs)},
                              {"TOLERANCE", tolerance(std::max(kLeast, here.rounding), worst)}});
}

/// Poles other than 0, so many of them that the test takes seconds.
std::vector<std::size_t> poles_to_find(const std::vector<Pole>& poles, Index n) {
  std::vector<std::size_t> moving, chosen;
  for (std::size_t k = 0; k < poles.size(); ++k)
    if (poles[k].omega > 0) moving.push_back(k);
  const double affordable = 2e9 / std::max(1.0, std::pow(double(n), 3));
  const auto count = static_cast<std::size_t>(std::clamp(affordable, 2.0, 60.0));
  if (moving.size() <= count) return moving;
  for (std::size_t i = 0; i < count; ++i)
    chosen.push_back(moving[i * (moving.size() - 1) / (count - 1)]);
  return chosen;
}

/// Distance of the eigenvalue of A that the test's search (kPoles) finds next to p, relative.
double pole_error(const MatrixXd& A, Complex p) {
  constexpr double kBeside = 1e-10;
  const Complex shift = p + kBeside * std::abs(p) * Complex(0.6, 0.8);
  const TestedResolvent resolvent(A, shift);
  Eigen::VectorXcd x(A.rows());
  for (Index i = 0; i < x.size(); ++i) x(i) = 1 + 0.1 * static_cast<double>(i * i % 7);
  Complex found;
  for (int step = 0; step < 6; ++step) {
    const Eigen::VectorXcd y = resolvent.solve(x);
    Index at = 0;
    y.cwiseAbs().maxCoeff(&at);
    found = shift - x(at) / y(at);
    x = y / y(at);
  }
  const double off = std::abs(found - p) / std::abs(p);
  return std::isfinite(off) ? off : HUGE_VAL;
}

std::string pole_test(const Naming& names, const ModelForm& form, const std::vector<Pole>& poles) {
  std::vector<std::string> items, which, lost;
  for (const Pole& p : poles) items.push_back(pair(p.s.real(), p.s.imag()));
  double worst = 0;
  for (const std::size_t k : poles_to_find(poles, form.A.rows())) {
    const double off = pole_error(form.A, poles[k].s);
    (is_provable(off) ? which : lost).push_back(std::to_string(k));
    if (is_provable(off)) worst = std::max(worst, off);
  }
  std::string text = filled(kPoles, {{"NAME", names.name},
                                     {"POLES", list(items, 4)},
                                     {"WHICH", list(which, 6)},
                                     {"TOLERANCE", tolerance(kLeastOfPole, worst)}});
  if (!lost.empty())
    text += fmt::format(
        "// Only counted, as the eigenvalues of A beside them are off by more than {}: poles\n// "
        "{}.\n",
        kProvable, fmt::join(lost, ", "));
  return text;
}

std::string trajectory_test(const Naming& names, const ModelForm& form, const MatrixXd& outputs) {
  std::vector<std::string> rows;
  for (Index k = 0; k < outputs.cols(); ++k) rows.push_back("\n      " + list(outputs.col(k), 7));
  std::string all;
  for (const std::string& row : rows) all += (all.empty() ? "{" : ",") + row;
  return filled(kTrajectory, {{"NAME", names.name},
                              {"NY", std::to_string(names.outputs.size())},
                              {"VALUES", all + "}"},
                              {"STEPS", std::to_string(outputs.cols())},
                              {"TOLERANCE", tolerance(kLeast, form.step_error)}});
}

/// Difference of the test's Taylor series (kTaylor) from `step`.
double series_error(const ModelForm& form, const Expected& expected, double h, double parts) {
  const Eigen::SparseMatrix<double> A = form.A.sparseView();
  const auto by_series = [&](VectorXd x, const VectorXd& u) {
    for (double part = 0; part < parts; ++part) {
      VectorXd term = A * x + form.B * u;
      for (int power = 1; power <= 24; ++power) {
        term *= h / parts / power;
        x += term;
        term = (A * term).eval();
      }
    }
    return x;
  };
  const MatrixXd C = form.C.cwiseAbs();
  VectorXd x = VectorXd::Zero(form.A.rows()), size = VectorXd::Zero(C.rows()), off = size;
  for (Index k = 0; k < expected.inputs.cols(); ++k) {
    const VectorXd u = expected.inputs.col(k), before = x;
    x = form.A_h * before + form.B_h * u;
    size = size.cwiseMax(C * x.cwiseAbs());
    if (k + 3 < expected.inputs.cols()) continue;
    off = off.cwiseMax((form.C * x - form.C * by_series(before, u)).cwiseAbs());
  }
  return worst_output(off, size, expected.points);
}

/// A comment in its place if the series would take more than some seconds.
std::string taylor_test(const Naming& names, const ModelForm& form, const Expected& expected) {
  constexpr const char* subject = "step against derivative";
  double fastest = 0;
  for (const Pole& p : expected.poles) fastest = std::max(fastest, p.omega);
  const double parts = std::max(1.0, std::ceil(fastest * names.sample_time));
  const double cost = 72 * parts * static_cast<double>(products(form));
  if (cost > 1e9)
    return fmt::format("\n// {}: not checked, it would take {:.0e} multiplications.\n", subject,
                       cost);
  const double error = series_error(form, expected, names.sample_time, parts);
  if (!is_provable(error)) return omitted(subject, error);
  return filled(kTaylor, {{"NAME", names.name},
                          {"NY", std::to_string(names.outputs.size())},
                          {"STEPS", std::to_string(expected.inputs.cols())},
                          {"SUBSTEPS", fmt::format("{:.0f}", parts)},
                          {"TOLERANCE", tolerance(kLeastOfSeries, error)}});
}

}  // namespace

std::string test_text(const Naming& names, const ModelForm& form, const Expected& expected) {
  const std::string states = std::to_string(names.states.size());
  std::string text = filled(kHead, {{"DIAGRAM", emit::quoted(names.diagram)},
                                    {"NAME", names.name},
                                    {"N", states},
                                    {"NU", std::to_string(names.inputs.size())},
                                    {"NY", std::to_string(names.outputs.size())}});
  const bool responds = !names.inputs.empty() && !names.outputs.empty();
  if (responds) text += transfer_test(names, form, expected.points);
  if (!names.states.empty()) text += pole_test(names, form, expected.poles);
  if (responds && expected.static_gain) text += static_gain_test(names, form, expected);
  if (names.sample_time > 0 && responds && !is_provable(form.step_error)) {
    text += omitted("trajectory, and step against derivative", form.step_error);
  } else if (names.sample_time > 0 && responds) {
    text += trajectory_test(names, form, expected.outputs);
    text += taylor_test(names, form, expected);
  }
  return text + filled(kEnd, {{"NAME", names.name}});
}

}  // namespace titop::emit
