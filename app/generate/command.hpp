#pragma once

#include <string>
#include <vector>

namespace titop::generate {

inline constexpr const char* kUsage =
    R"(  titop generate DIAGRAM.json              a random diagram; DIAGRAM.answer.json: its answer by
                                           equations assembled by hand; DIAGRAM_test.cpp: a
                                           test that compares both
      --seed N                             equal numbers give equal diagrams; 1 if left out
      --family scalar|spatial              spring-masses, or bodies and joints in space;
                                           if left out: scalar, or as the mistake requires
      --shape chain|tree|star              --bodies N    --loops N
      --damping none|some|all              --stiffness LOW HIGH    powers of two
      --no-controllers                     --twins       equal bodies in pairs
      --states N                           dense controllers of N states, 1 to 12, with one or two
                                           inputs, in loops and out of them
      --mistake CODE                       planted: no-equation, frame, improper ...
)";

/// `titop generate`. Throws std::invalid_argument for unknown words, Error (bad_file) if it cannot
/// write.
void command(const std::vector<std::string>& words);

}  // namespace titop::generate
