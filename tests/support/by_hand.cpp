// What the examples check with, once more for the tests.
#include "../../examples/by_hand/by_hand.cpp"
