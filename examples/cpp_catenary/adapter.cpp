// Adapter of `simulator.hpp`, with the kit `pantocheck_adapter.hpp`.
//
// Try it:  g++ -O2 -std=c++17 -o adapter adapter.cpp && pantocheck system check ./adapter

#include "simulator.hpp"

/// Features that the simulator takes into account; a case with another one is skipped.
const std::set<std::string> features = {
    "bending_stiffness", "chain", "dropper_mass", "droppers", "gradients", "listed_spans", "presag", "rayleigh_damping",
    "single_supports", "steady_arm_mass", "steady_arms", "support_dampers", "surveyed_wire_heights", "wire_height"};

int main() {
    return pantocheck::serve("string catenary in C++", "1.0", simulator::simulate, features);
}
