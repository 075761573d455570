// Adapter of `simulator.hpp`, with the kit `pantocheck_adapter.hpp`.
//
// Try it:  g++ -O2 -std=c++17 -o adapter adapter.cpp && pantocheck system check ./adapter

#include "simulator.hpp"

using pantocheck::Json;
using pantocheck::Skip;

/// Refuse cases that the simulator does not support, with the reason.
void check_supported(const Json& case_) {
    if (!case_.has("speed_km_h")) throw Skip("checks of the line at rest are not supported");
    if (case_["pantographs"].items.size() != 1) throw Skip("only one pantograph is supported");
    const Json &train = case_["pantographs"][0], &line = case_["line"], &derived = case_["derived"]["line"];
    if (!train.has("uplift_force_N") || train.has("target_mean_force_N") || train.has("applied_forces"))
        throw Skip("only a fixed uplift force at one point is supported");
    if (!train.has("chain") || train["chain"]["base_spring_unstretched"].characters != "working_height")
        throw Skip("only chains of masses that are unstretched at the working height are supported");
    if (line.has("stitch_wire") || line["contact_wire"]["number"] > 1 || !line["damping"]["modal"].items.empty())
        throw Skip("stitch wires, twin contact wires and modal damping are not supported");
    if (derived["contact_wire"].has("lateral_position_m")) throw Skip("stagger is not supported");
    for (double damper : derived["steady_arms"]["vertical_damper_N_s_m"].numbers())
        if (damper != 0) throw Skip("dampers of steady arms are not supported");
    const Json& held = derived["messenger_supports"]["held_along_track"];
    if (held.is_true || held.kind == Json::list) throw Skip("messenger wires held along the track are not supported");
    for (const char* key : {"contact_wire", "messenger_wire"})
        if (derived[key].has("stretches") || derived[key].has("irregularity"))
            throw Skip("changes of a wire and its irregularity are not supported");
    if (derived.has("point_masses")) throw Skip("point masses are not supported");
}

int main() {
    return pantocheck::serve("string catenary in C++", "1.0", [](const Json& case_) {
        check_supported(case_);
        return simulator::simulate(case_);
    });
}
