// Small catenary simulator: two wires in finite differences, droppers that slacken, a pantograph of lumped masses.
//
// Deflections w [m] are positive upwards and start from the initial state of the line. The time integration is explicit
// (semi-implicit Euler). At rest, the contact wire is a string between its droppers and arms. These are the equations of
// examples/string_catenary, apart from the bending of the wire at rest.

#pragma once

#include <algorithm>
#include <cmath>

#include "pantocheck_adapter.hpp"

namespace simulator {

using pantocheck::Json;
using pantocheck::Numbers;

constexpr double gravity = 9.81;
/// Duration [s] and additional mass coefficient [1/s] of a simulation that brings the line to rest.
constexpr double relaxation_s = 4.0, relaxation_damping = 3.0;

/// Position on the grid: left node, and weight of the right node.
struct Point {
    std::size_t node;
    double weight;

    double interpolate(const Numbers& field) const { return (1 - weight) * field[node] + weight * field[node + 1]; }
    void distribute(Numbers& field, double value) const {
        field[node] += (1 - weight) * value;
        field[node + 1] += weight * value;
    }
};

/// Tensioned beam, pinned at both ends, with n nodes at a distance h [m].
struct Wire {
    double tension, bending, alpha, beta;
    Numbers mass, w, v, load;

    Wire(const Json& data, const Json& damping, std::size_t n, double h)
        : tension(data["tension_N"] / h),
          bending(data["bending_stiffness_N_m2"] / (h * h * h)),
          alpha(damping["mass_coefficient_1_s"]),
          beta(damping["stiffness_coefficient_s"]),
          mass(n, data["mass_kg_m"] * h),
          w(n), v(n), load(n), shape_(n), second_(n) {}

    double largest_stiffness() const { return 4 * tension + 16 * bending; }

    /// Force of tension, bending and damping on each node [N].
    void compute_load(double extra_damping) {
        const std::size_t n = w.size();
        for (std::size_t i = 0; i < n; ++i) shape_[i] = w[i] + beta * v[i];
        for (std::size_t i = 1; i + 1 < n; ++i) second_[i] = shape_[i - 1] - 2 * shape_[i] + shape_[i + 1];
        load[0] = load[n - 1] = 0;
        for (std::size_t i = 1; i + 1 < n; ++i)
            load[i] = tension * second_[i] - bending * (second_[i - 1] - 2 * second_[i] + second_[i + 1]) -
                      (alpha + extra_damping) * mass[i] * v[i];
    }
    void step(double dt) {
        for (std::size_t i = 1; i + 1 < w.size(); ++i) {
            v[i] += dt * load[i] / mass[i];
            w[i] += dt * v[i];
        }
    }

private:
    Numbers shape_, second_;
};

/// A value of arms or supports is one number, or a list if they differ.
inline Numbers spread(const Json& value, std::size_t count) {
    Numbers numbers = value.numbers();
    return numbers.size() == 1 ? Numbers(count, numbers[0]) : numbers;
}

/// Contact wire, messenger wire, droppers, steady arms and messenger supports.
class Line {
public:
    Line(const Json& data, const Json& derived, double element)
        : cells_(std::lround(derived["contact_wire"]["end_m"] / element)),
          h_(derived["contact_wire"]["end_m"] / cells_),
          contact(data["contact_wire"], data["damping"]["contact_wire"], cells_ + 1, h_),
          messenger(data["messenger_wire"], data["damping"]["messenger_wire"], cells_ + 1, h_) {
        const Json &droppers = derived["droppers"], &arms = derived["steady_arms"];
        const Json& supports = derived["messenger_supports"];
        const Numbers masses = droppers["mass_kg"].numbers();
        stiffness_ = droppers["stiffness_N_m"].numbers();
        preload_ = droppers["vertical_force_N"].numbers();
        dropper_beta_ = droppers["stiffness_coefficient_s"];
        for (double x : droppers["position_m"].numbers()) droppers_.push_back(locate(x));
        for (std::size_t i = 0; i < droppers_.size(); ++i) {
            droppers_[i].distribute(contact.mass, masses[i] / 2 + droppers["lower_clamp_kg"]);
            droppers_[i].distribute(messenger.mass, masses[i] / 2 + droppers["upper_clamp_kg"]);
        }
        support_position = arms["position_m"].numbers();
        const std::size_t count = support_position.size();
        arm_stiffness_ = spread(arms["vertical_stiffness_N_m"], count);
        arm_beta_ = arms["stiffness_coefficient_s"];
        const Numbers arm_mass = spread(arms["mass_kg"], count);
        for (std::size_t i = 0; i < count; ++i) {
            arms_.push_back(locate(support_position[i]));
            arms_[i].distribute(contact.mass, arm_mass[i]);
        }
        for (double x : supports["position_m"].numbers()) supports_.push_back(locate(x));
        support_stiffness_ = spread(supports["vertical_stiffness_N_m"], supports_.size());
        support_damping_ = spread(supports["vertical_damper_N_s_m"], supports_.size());
        place_at_rest(data, derived);
    }

    Point locate(double x) const {
        const std::size_t node = std::min(static_cast<std::size_t>(std::max(x, 0.0) / h_), cells_ - 1);
        return {node, x / h_ - node};
    }
    double height(const Point& point) const { return point.interpolate(rest_height) + point.interpolate(contact.w); }
    double uplift(std::size_t support) const { return arms_[support].interpolate(contact.w); }

    /// Largest stable time step [s], with a margin.
    double stable_step(double contact_stiffness) const {
        auto largest = [](const Numbers& values) { return *std::max_element(values.begin(), values.end()); };
        const double point =
            largest(stiffness_) + std::max({largest(arm_stiffness_), largest(support_stiffness_), contact_stiffness});
        double ratio = 0;
        for (const Wire* wire : {&contact, &messenger})
            ratio = std::max(ratio, (wire->largest_stiffness() + 2 * point) /
                                        *std::min_element(wire->mass.begin(), wire->mass.end()));
        return 0.5 / std::sqrt(ratio);
    }

    /// Advance both wires by one time step, with the contact force upwards at a point.
    void step(double dt, const Point& place, double force, double extra_damping = 0) {
        contact.compute_load(extra_damping);
        messenger.compute_load(extra_damping);
        for (std::size_t i = 0; i < droppers_.size(); ++i) {
            const Point& at = droppers_[i];
            const double stretch = at.interpolate(messenger.w) - at.interpolate(contact.w);
            const double rate = at.interpolate(messenger.v) - at.interpolate(contact.v);
            const double tension = std::max(0.0, preload_[i] + stiffness_[i] * (stretch + dropper_beta_ * rate));
            at.distribute(contact.load, tension - preload_[i]);
            at.distribute(messenger.load, preload_[i] - tension);
        }
        for (std::size_t i = 0; i < arms_.size(); ++i)
            arms_[i].distribute(contact.load, -arm_stiffness_[i] * (arms_[i].interpolate(contact.w) +
                                                                     arm_beta_ * arms_[i].interpolate(contact.v)));
        for (std::size_t i = 0; i < supports_.size(); ++i)
            supports_[i].distribute(messenger.load, -support_stiffness_[i] * supports_[i].interpolate(messenger.w) -
                                                        support_damping_[i] * supports_[i].interpolate(messenger.v));
        place.distribute(contact.load, force);
        contact.step(dt);
        messenger.step(dt);
    }

    /// Bring the line to rest under a force at a position; height of the contact wire there [m].
    double settle(double x, double force, double dt) {
        const Point place = locate(x);
        for (long i = std::lround(relaxation_s / dt); i > 0; --i) step(dt, place, force, relaxation_damping);
        for (Wire* wire : {&contact, &messenger}) std::fill(wire->v.begin(), wire->v.end(), 0.0);
        return height(place);
    }

private:
    std::size_t cells_;
    double h_;

    /// Height of the contact wire at rest [m]: a string between anchors, droppers, and arms that carry a share of it.
    void place_at_rest(const Json& data, const Json& derived) {
        std::map<double, double> held;
        const Numbers limits = derived["span_limits_m"].numbers(), at_limits = derived["contact_wire"]["height_m"].numbers();
        const Numbers x = derived["droppers"]["position_m"].numbers();
        const Numbers at_droppers = derived["droppers"]["contact_wire_height_m"].numbers();
        const Numbers carried = derived["steady_arms"]["vertical_force_N"].numbers();
        for (std::size_t i = 0; i < x.size(); ++i) held[x[i]] = at_droppers[i];
        for (std::size_t i = 0; i < limits.size(); ++i)
            if (i == 0 || i + 1 == limits.size() || carried.at(i - 1) != 0) held[limits[i]] = at_limits[i];
        const double sag = gravity * data["contact_wire"]["mass_kg_m"] / (2 * data["contact_wire"]["tension_N"]);
        for (std::size_t i = 0; i <= cells_; ++i) {
            const double place = std::min(std::max(i * h_, held.begin()->first), held.rbegin()->first);
            auto right = held.upper_bound(place);
            if (right == held.end()) --right;
            const auto left = std::prev(right);
            const double a = place - left->first, b = right->first - place;
            rest_height.push_back((left->second * b + right->second * a) / (a + b) - sag * a * b);
        }
    }

    std::vector<Point> droppers_, arms_, supports_;
    Numbers stiffness_, preload_, arm_stiffness_, support_stiffness_, support_damping_;
    double dropper_beta_ = 0, arm_beta_ = 0;

public:
    Wire contact, messenger;
    Numbers rest_height, support_position;
};

/// Pantograph of masses in series above the ground.
struct Chain {
    Numbers mass, stiffness, damping, force, z, v;
    double working_height;

    /// Equilibrium under the uplift force, with the head at a height.
    Chain(const Json& train, double working_height_, double head)
        : mass(train["chain"]["masses_kg"].numbers()),
          stiffness(train["chain"]["stiffness_N_m"].numbers()),
          damping(train["chain"]["damping_N_s_m"].numbers()),
          force(mass.size()), z(mass.size()), v(mass.size()),
          working_height(working_height_) {
        const double uplift = train["uplift_force_N"];
        force[find_mass(train["chain"], train["chain"]["uplift_force_on"])] = uplift;
        z.back() = head;
        double above = 0;
        for (std::size_t i = mass.size() - 1; i > 0; --i) {
            above += force[i];
            z[i - 1] = z[i] - (above - uplift) / stiffness[i];
        }
    }

    /// Index of a mass given by its name, or by its number from the ground, from 1.
    static std::size_t find_mass(const Json& chain, const Json& point) {
        if (point.kind == Json::number) return static_cast<std::size_t>(double(point)) - 1;
        for (std::size_t i = 0; i < chain["names"].items.size(); ++i)
            if (chain["names"][i].characters == point.characters) return i;
        throw std::runtime_error("the pantograph has no mass " + point.characters);
    }

    void step(double dt, double contact_force) {
        Numbers load = force;
        for (std::size_t i = 0; i < mass.size(); ++i) {
            const double below = i ? z[i - 1] : working_height, rate = i ? v[i - 1] : 0.0;
            const double spring = stiffness[i] * (z[i] - below) + damping[i] * (v[i] - rate);
            load[i] -= spring;
            if (i) load[i - 1] += spring;
        }
        load.back() -= contact_force;
        for (std::size_t i = 0; i < mass.size(); ++i) {
            v[i] += dt * load[i] / mass[i];
            z[i] += dt * v[i];
        }
    }
};

/// Simulate a case with one pantograph.
inline pantocheck::Record simulate(const Json& case_) {
    const Json& train = case_["pantographs"][0];
    const Json& derived = case_["derived"];
    const double speed = case_["speed_km_h"] / 3.6, step = case_["discretisation"]["time_step_s"];
    const double contact_stiffness = train["contact"]["stiffness_N_m"], uplift_force = train["uplift_force_N"];
    Line line(case_["line"], derived["line"], case_["discretisation"]["element_m"]);
    const long substeps = std::lround(std::ceil(step / line.stable_step(contact_stiffness)));
    const double dt = step / substeps, start = train["start_m"];
    const double head = line.settle(start, uplift_force, dt) + uplift_force / contact_stiffness;
    Chain chain(train, derived["train"]["pantographs"][0]["working_height_m"], head);
    const long steps = std::lround((train["end_m"] - start) / speed / step);
    pantocheck::Record record;
    record.support_position_m = line.support_position;
    record.uplift_m.resize(line.support_position.size());
    Numbers position, force, height;
    double contact_force = uplift_force, x = start, wire = 0;
    for (long n = 0; n < steps; ++n) {
        for (long substep = 1; substep <= substeps; ++substep) {
            x = start + speed * (n * step + substep * dt);
            const Point place = line.locate(x);
            line.step(dt, place, contact_force);
            chain.step(dt, contact_force);
            wire = line.height(place);
            contact_force = contact_stiffness * std::max(0.0, chain.z.back() - wire);
        }
        record.time_s.push_back((n + 1) * step);
        position.push_back(x);
        force.push_back(contact_force);
        height.push_back(wire);
        for (std::size_t i = 0; i < record.uplift_m.size(); ++i) record.uplift_m[i].push_back(line.uplift(i));
    }
    record.position_m = {position};
    record.force_N = {force};
    record.contact_height_m = {height};
    record.start.place_m = start;  // equilibrium under the uplift force, full speed from the start
    record.dt_s = step;
    record.element_m = case_["discretisation"]["element_m"];
    record.note = "Finite differences, explicit time stepping.";
    return record;
}

}  // namespace simulator
