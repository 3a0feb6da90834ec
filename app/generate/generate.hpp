#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "generate/plan.hpp"
#include "generate/shape.hpp"

/// Random scenes with their answers, for testing titop and other programs with. A scene is drawn as
/// plain data, written as a diagram file, and answered from equations of motion that are assembled
/// by hand (assembly.hpp), without the library.
namespace titop::generate {

struct GenerateOptions {
  std::uint64_t seed = 1;
  Family family = Family::scalar;  ///< mixed is spatial: all such scenes have spring-masses
  Shape shape = Shape::tree;
  int bodies = 6;
  int loops = 0;  ///< chains that close, through the ground or among themselves
  Damping damping = Damping::some;
  int stiffness_low = 3, stiffness_high = 9;  ///< powers of two [N/m, N m/rad]
  bool controllers = true;
  int states = 0;            ///< of each controller, which is dense then; 0: one or two
  bool twins = false;        ///< every second part a copy of its neighbour: removable states
  std::string mistake = {};  ///< code of a mistake to plant; "": none
};

using Json = nlohmann::ordered_json;

/// The same seed gives the same scene on every machine. Throws std::overflow_error if its ratios
/// outgrow 64 bits.
ScenePlan draw(const GenerateOptions& options);

/// The diagram file. Each row of a list is on one line.
Json scene(const ScenePlan& plan);

/// The expected values: {"order", "poles", "transfer"}. Order: of the minimal model, computed
/// modulo a prime and again in 100 digits. Poles: with Im s >= 0, zeros as [0, 0]. Throws
/// std::domain_error if the equations have no solution, std::logic_error if the two orders differ.
Json answer(const ScenePlan& plan, std::uint64_t seed);

/// Plants a mistake of this code into the scene; the answer is {"refused": {"code", "names"}}: the
/// names that the message must contain. Throws std::invalid_argument for a code that cannot be
/// planted, std::domain_error for a scene without a place for it, with the option that brings one.
struct Spoilt {
  Json scene, answer;
};
Spoilt spoil(Json scene, const std::string& code);

/// Spring-masses have no place for this mistake: they have neither frames nor modes.
bool needs_space(const std::string& code);

/// The scene, its answer, and the source of a doctest program (needs titop) that compares them.
struct Generated {
  Json scene, answer;
};
/// Draws with this seed, and with the next ones while the scene has no answer, numbers too long for
/// a Ratio, or no place for the mistake. Throws std::invalid_argument if a hundred seeds fail, with
/// the reason of the last.
Generated generate(const GenerateOptions& options);
std::string test_source(const Generated& generated, const std::string& scene_file);

/// JSON with one line per item of the outermost lists.
std::string text(const Json& json);

}  // namespace titop::generate
