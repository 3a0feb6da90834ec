#pragma once

#include "generate/draws.hpp"

namespace titop_test {

using titop::generate::Rng;

}  // namespace titop_test
