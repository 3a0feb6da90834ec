#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/compiler/certificate/without_rounding.hpp>
#include <titop/compiler/minreal/poles_of.hpp>
#include <titop/compiler/passes/passes.hpp>
#include <titop/compiler/realization/energy.hpp>
#include <titop/compiler/realization/write_model.hpp>
#include <titop/compiler/system/compile_graph.hpp>
#include <titop/compiler/system/damping_of_bodies.hpp>
#include <titop/compiler/system/system.hpp>
#include <titop/compiler/system/system_data.hpp>
#include <titop/compiler/system/transfer_part.hpp>
#include <titop/graph/closed_form.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/support/parallel.hpp>

namespace titop {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

int System::order() const { return data_->states.order(); }
const std::vector<std::string>& System::states() const& { return data_->state_names(); }
const std::vector<std::string>& System::inputs() const& { return data_->layout().inputs; }
const std::vector<std::string>& System::outputs() const& { return data_->layout().outputs; }
int System::input(const std::string& name) const { return position_of(inputs(), name, "input"); }
int System::output(const std::string& name) const { return position_of(outputs(), name, "output"); }
const Stage& System::stage() const& { return data_->skeleton->stage; }
const std::vector<Note>& System::notes() const& { return data_->noted(); }

System::Rates System::apply(const VectorXd& x, const VectorXd& u) const {
  require_state_space(data_->graph());
  if (x.size() != order() || u.size() != static_cast<Eigen::Index>(inputs().size()))
    throw Error(Code::size, fmt::format("apply: x has {} entries, u has {}", x.size(), u.size()),
                fmt::format("x needs {}, u needs {}", order(), inputs().size()));
  const VectorXd all = data_->states.expanded(x, u);
  solve::RowMatrix<double> known(all.size() + u.size(), 1);
  known << all, u;
  const detail::RateColumns r = detail::rates(*data_, known);
  return {data_->states.kept_rows(VectorXd(r.xdot)), r.y};
}

MatrixXcd System::transfer(std::complex<double> s, Precision precision) const {
  return detail::transfer_of(*data_, s, precision);
}

std::vector<MatrixXcd> System::frequency_response(std::span<const double> omega, int threads,
                                                  Precision precision) const {
  std::vector<MatrixXcd> result(omega.size());
  detail::parallel(omega.size(), threads, [&] {
    return [&](std::size_t i) { result[i] = transfer({0, omega[i]}, precision); };
  });
  return result;
}

MatrixXd System::static_gain() const {
  try {
    return transfer(0).real();
  } catch (const Error& error) {
    // A block may have a pole at 0 that the system has not: a hinge with a spring.
    if (!error.has(Code::singular)) throw;
    return state_space().transfer(0).real();
  }
}

const detail::DenseModel& System::dense() const {
  require_state_space(data_->graph());
  return data_->dense.get([&] { return detail::dense_model(*data_); });
}

const StateSpace& System::state_space() const& { return *dense().minimal.model; }

const OrderVerdict& System::order_verdict() const& { return dense().minimal.order; }

const std::vector<std::pair<std::string, double>>& System::dense_seconds() const& {
  return dense().seconds;
}

void System::write(StateSpace& model, int threads) const {
  require_state_space(data_->graph());
  detail::write_dense(*data_, model, threads);
}

void System::write(Descriptor& form) const {
  require_state_space(data_->graph());
  detail::write_descriptor(*data_, form);
}

Descriptor System::descriptor() const {
  Descriptor form;
  write(form);
  return form;
}

std::vector<Pole> System::poles() const {
  const StateSpace& model = state_space();
  const bool whole = model.order() > 0 && !order_verdict().judged;
  // Each state that `minimize` has removed added a product to the entries of A.
  const double sums = 1.0 + order() - model.order();
  const bool chains = model.order() == order() && !data_->states.trivial();
  const auto rounding = [&]() -> MatrixXd {
    if (whole) return detail::rounding_of(*data_, model).A;
    return sums * linalg::kEpsilon * model.A.cwiseAbs();
  };
  std::vector<Pole> list =
      detail::poles_of(model, rounding, chains ? detail::potential_energy(*data_) : MatrixXd());
  detail::compare_with_bodies(*data_, list);
  return list;
}

namespace {

Certificate with_dense(Certificate c, double against_factors, const detail::DenseError& error) {
  c.dense_against_factors = against_factors;
  c.dense_error = error.beside_largest.error;
  c.dense_error_s = error.beside_largest.s;
  c.dense_error_where_small = error.where_small.error;
  c.dense_error_where_small_s = error.where_small.s;
  return c;
}

}  // namespace

Certificate System::certificate() const { return data_->checked().certificate; }

Certificate System::dense_certificate() const {
  const detail::Realization& written = dense().written;
  return with_dense(certificate(), written.against_factors, written.error);
}

Certificate System::certificate(const StateSpace& written) const {
  detail::require_written(*data_, written);
  return with_dense(certificate(), detail::dense_difference(*data_, written),
                    detail::dense_error(*data_, written));
}

namespace {

std::string lines_of(const std::vector<Note>& notes) {
  std::string text;
  for (const Note& n : notes)
    text += fmt::format("  {:<9} {:<10} {}\n", n.pass, to_string(n.kind), n.text);
  return text;
}

}  // namespace

std::string System::log() const {
  const auto count = [](std::size_t n, const char* subject) {
    return fmt::format("{} {}{}", n, subject, n == 1 ? "" : "s");
  };
  return fmt::format("{}: {}, {}, {}\n", data_->graph().name, count(states().size(), "state"),
                     count(inputs().size(), "input"), count(outputs().size(), "output")) +
         lines_of(notes());
}

const std::vector<Note>& System::dense_notes() const& {
  const detail::DenseModel& m = dense();
  return data_->all_dense_notes.get([&] {
    std::vector<Note> all = m.written.notes;
    all.insert(all.end(), m.minimal.notes.begin(), m.minimal.notes.end());
    if (m.minimal.order.judged && detail::has_damped_bodies(*data_)) try {
        const std::vector<Note> more = detail::damping_notes(poles());
        all.insert(all.end(), more.begin(), more.end());
      } catch (const Error&) {
        all.push_back(
            {Note::Kind::unchecked, "dense",
             "the damping of modes is not compared with that of bodies: no poles are found"});
      }
    return all;
  });
}

std::string System::dense_log() const { return lines_of(dense_notes()); }

const std::vector<std::pair<std::string, double>>& System::seconds() const& {
  return data_->seconds;
}

System System::update(const ParameterList& values) const {
  return System(detail::updated(*data_, values));
}

std::vector<std::pair<std::string, double>> System::parameters() const {
  std::vector<std::pair<std::string, double>> result;
  const auto& list = data_->graph().parameters;
  for (std::size_t i = 0; i < list.size(); ++i)
    result.emplace_back(list[i].name, data_->numbers.parameters[i]);
  return result;
}

System compile(const Diagram& diagram, const Options& options) {
  return System(detail::compile_graph(diagram.graph(), options));
}

const detail::SystemData& detail::data_of(const System& system) { return *system.data_; }

const detail::Check& detail::SystemData::checked() const {
  return check.get([&] { return certify(*this); });
}

const std::vector<Note>& detail::SystemData::noted() const {
  return all_notes.get([&] {
    std::vector<Note> all = passes::degree_notes(skeleton->stage.angles, numbers.parameters);
    for (const std::vector<Note>* more : {&skeleton->stage.notes, &notes, &checked().notes})
      all.insert(all.end(), more->begin(), more->end());
    return all;
  });
}

}  // namespace titop
