#pragma once

#include <string>
#include <vector>

namespace titop::generate {

inline constexpr const char* kUsage =
    R"(  titop generate SCENE.json              a random scene, its answer SCENE.answer.json by equations
                                         assembled by hand, and SCENE_test.cpp that compares:
      --seed N                           the same number, the same scene; 1
      --family scalar|spatial            spring-masses, or bodies and joints in space;
                                         left out: scalar, or what the mistake needs
      --shape chain|tree|star            --bodies N    --loops N
      --damping none|some|all            --stiffness LOW HIGH    powers of two
      --no-controllers                   --twins                 parts that swing alike
      --mistake CODE                     planted: no-equation, frame, improper ...
)";

/// `titop generate`. Throws std::invalid_argument for unknown words, Error (bad_file) if it cannot
/// write.
void command(const std::vector<std::string>& words);

}  // namespace titop::generate
