// Kit for adapters in C++17: messages, record files and digests. It needs the standard library only.
//
// An adapter is a function that simulates a case, and one call:
//
//     Record simulate(const Json& case_) { ... return record; }
//     int main() { return serve("my simulator", "1.0", simulate, {"chain", "droppers", "stagger", "steady_arms"}); }
//
// The last argument lists what your simulator takes into account, by the names in docs/systems.md. A case that uses
// another feature is skipped before `simulate` is called.
//
// Try it:  g++ -O2 -std=c++17 -o adapter adapter.cpp && pantocheck system check ./adapter

#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iomanip>
#include <iostream>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace pantocheck {

using Numbers = std::vector<double>;

/// The simulator does not support a case. Its verdict is `skip`, which is not `fail`; the exit code of the run is 1.
struct Skip : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Value of JSON: null, truth value, number, text, list or table.
struct Json {
    enum Kind { null, truth, number, text, list, table } kind = null;
    bool is_true = false;
    double value = 0;
    std::string characters;
    std::vector<Json> items;
    std::map<std::string, Json> entries;

    bool is_null() const { return kind == null; }

    /// Whether a table has a key with a value other than null.
    bool has(const std::string& key) const {
        auto found = entries.find(key);
        return found != entries.end() && !found->second.is_null();
    }
    /// Value of a key; a case always has the keys of its schema.
    const Json& operator[](const std::string& key) const {
        auto found = entries.find(key);
        if (found == entries.end()) throw std::runtime_error("the case has no key " + key);
        return found->second;
    }
    const Json& operator[](std::size_t index) const { return items.at(index); }
    operator double() const {
        if (kind != number) throw std::runtime_error("a value of the case is not a number");
        return value;
    }
    /// All numbers of a list, nested lists one after the other.
    Numbers numbers() const {
        if (kind == number) return {value};
        Numbers all;
        for (const Json& item : items)
            for (double one : item.numbers()) all.push_back(one);
        return all;
    }
};

/// Parser of one JSON text.
class JsonParser {
public:
    explicit JsonParser(const std::string& text) : text_(text) {}

    Json parse() {
        Json value = parse_value();
        skip_blanks();
        if (place_ != text_.size()) fail();
        return value;
    }

private:
    [[noreturn]] void fail() const { throw std::runtime_error("a message is not valid JSON"); }
    void skip_blanks() {
        while (place_ < text_.size() && std::string(" \t\r\n").find(text_[place_]) != std::string::npos) ++place_;
    }
    char next() {
        if (place_ >= text_.size()) fail();
        return text_[place_++];
    }
    bool accept(char wanted) {
        skip_blanks();
        if (place_ >= text_.size() || text_[place_] != wanted) return false;
        ++place_;
        return true;
    }
    void expect(const std::string& word) {
        if (text_.compare(place_, word.size(), word) != 0) fail();
        place_ += word.size();
    }
    Json parse_value() {
        Json value;
        skip_blanks();
        char first = place_ < text_.size() ? text_[place_] : '\0';
        if (first == '{') {
            value.kind = Json::table;
            ++place_;
            if (accept('}')) return value;
            do {
                skip_blanks();
                std::string key = parse_text();
                if (!accept(':')) fail();
                value.entries[key] = parse_value();
            } while (accept(','));
            if (!accept('}')) fail();
        } else if (first == '[') {
            value.kind = Json::list;
            ++place_;
            if (accept(']')) return value;
            do value.items.push_back(parse_value());
            while (accept(','));
            if (!accept(']')) fail();
        } else if (first == '"') {
            value.kind = Json::text;
            value.characters = parse_text();
        } else if (first == 't' || first == 'f') {
            value.kind = Json::truth;
            value.is_true = first == 't';
            expect(value.is_true ? "true" : "false");
        } else if (first == 'n') {
            expect("null");
        } else {
            value.kind = Json::number;
            std::size_t length = 0;
            try {
                value.value = std::stod(text_.substr(place_, 40), &length);
            } catch (const std::exception&) {
                fail();
            }
            place_ += length;
        }
        return value;
    }
    std::string parse_text() {
        if (next() != '"') fail();
        std::string result;
        for (char c = next(); c != '"'; c = next()) {
            if (c != '\\') {
                result += c;
                continue;
            }
            char escaped = next();
            static const std::map<char, char> plain = {{'n', '\n'}, {'t', '\t'}, {'r', '\r'}, {'b', '\b'}, {'f', '\f'}};
            if (escaped != 'u') {
                auto found = plain.find(escaped);
                result += found == plain.end() ? escaped : found->second;
                continue;
            }
            append_utf8(result, parse_code());
        }
        return result;
    }
    unsigned parse_code() {
        unsigned code = std::stoul(text_.substr(place_, 4), nullptr, 16);
        place_ += 4;
        if (code >= 0xD800 && code < 0xDC00 && text_.compare(place_, 2, "\\u") == 0) {
            unsigned low = std::stoul(text_.substr(place_ + 2, 4), nullptr, 16);
            place_ += 6;
            code = 0x10000 + ((code - 0xD800) << 10) + (low - 0xDC00);
        }
        return code;
    }
    static void append_utf8(std::string& result, unsigned code) {
        if (code < 0x80) {
            result += static_cast<char>(code);
            return;
        }
        int extra = code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;
        static const unsigned marks[] = {0, 0xC0, 0xE0, 0xF0};
        result += static_cast<char>(marks[extra] | (code >> (6 * extra)));
        for (int shift = 6 * (extra - 1); shift >= 0; shift -= 6)
            result += static_cast<char>(0x80 | ((code >> shift) & 0x3F));
    }

    const std::string& text_;
    std::size_t place_ = 0;
};

/// Text in quotes, as JSON and TOML write it.
inline std::string quote(const std::string& text) {
    std::ostringstream out;
    out << '"';
    for (unsigned char c : text) {
        if (c == '"' || c == '\\') out << '\\' << c;
        else if (c < 0x20 || c == 0x7F) out << "\\u" << std::hex << std::setw(4) << std::setfill('0') << int(c) << std::dec;
        else out << c;
    }
    out << '"';
    return out.str();
}

/// SHA-256 in hexadecimal (FIPS 180-4).
inline std::string sha256(std::string data) {
    static const std::array<std::uint32_t, 64> k = {
        0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
        0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
        0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
        0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
        0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
        0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
        0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
        0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};
    std::array<std::uint32_t, 8> h = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                      0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
    auto turn = [](std::uint32_t x, int n) { return (x >> n) | (x << (32 - n)); };
    const std::uint64_t bits = std::uint64_t(data.size()) * 8;
    data += '\x80';
    while (data.size() % 64 != 56) data += '\0';
    for (int shift = 56; shift >= 0; shift -= 8) data += static_cast<char>(bits >> shift);
    for (std::size_t block = 0; block < data.size(); block += 64) {
        std::array<std::uint32_t, 64> w{};
        for (int i = 0; i < 64; ++i) {
            if (i < 16) {
                for (int byte = 0; byte < 4; ++byte)
                    w[i] = (w[i] << 8) | static_cast<unsigned char>(data[block + 4 * i + byte]);
                continue;
            }
            std::uint32_t s0 = turn(w[i - 15], 7) ^ turn(w[i - 15], 18) ^ (w[i - 15] >> 3);
            std::uint32_t s1 = turn(w[i - 2], 17) ^ turn(w[i - 2], 19) ^ (w[i - 2] >> 10);
            w[i] = w[i - 16] + s0 + w[i - 7] + s1;
        }
        auto v = h;
        for (int i = 0; i < 64; ++i) {
            std::uint32_t s1 = turn(v[4], 6) ^ turn(v[4], 11) ^ turn(v[4], 25);
            std::uint32_t choice = (v[4] & v[5]) ^ (~v[4] & v[6]);
            std::uint32_t first = v[7] + s1 + choice + k[i] + w[i];
            std::uint32_t s0 = turn(v[0], 2) ^ turn(v[0], 13) ^ turn(v[0], 22);
            std::uint32_t majority = (v[0] & v[1]) ^ (v[0] & v[2]) ^ (v[1] & v[2]);
            v = {first + s0 + majority, v[0], v[1], v[2], v[3] + first, v[4], v[5], v[6]};
        }
        for (int i = 0; i < 8; ++i) h[i] += v[i];
    }
    std::ostringstream out;
    for (std::uint32_t word : h) out << std::hex << std::setw(8) << std::setfill('0') << word;
    return out.str();
}

/// Start of a simulation: place of the last pantograph [m], length of the ramp of force and speed [m], and state.
struct Start {
    double place_m = 0, ramp_m = 0;
    std::string state = "equilibrium_under_uplift_forces";
};

/// Result of a simulation: evenly spaced samples in SI units, one list per pantograph or support.
/// Leave out a channel that the simulator does not compute: criteria that need it are skipped.
struct Record {
    Numbers time_s;
    std::vector<Numbers> position_m, force_N, contact_height_m;
    Numbers support_position_m;
    std::vector<Numbers> uplift_m;
    Start start;
    double dt_s = 0, element_m = 0;
    std::string note;
};

inline std::string read_file(const std::string& name) {
    std::ifstream file(name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

inline std::string join(const Numbers& numbers) {
    std::ostringstream out;
    out.precision(9);
    for (std::size_t i = 0; i < numbers.size(); ++i) out << (i ? ", " : "") << numbers[i];
    return out.str();
}

/// Write table and sidecar into the working folder.
inline void write_record(const Record& record, const Json& case_, const std::string& system, double wall_s) {
    std::ofstream table("record.csv", std::ios::binary);
    std::vector<const Numbers*> columns = {&record.time_s};
    table << "time_s";
    auto add = [&](const std::vector<Numbers>& channels, const std::string& name, const std::string& unit) {
        for (std::size_t i = 0; i < channels.size(); ++i) {
            table << ',' << name << '_' << i + 1 << '_' << unit;
            columns.push_back(&channels[i]);
        }
    };
    add(record.position_m, "position", "m");
    add(record.force_N, "force", "N");
    add(record.contact_height_m, "contact_height", "m");
    add(record.uplift_m, "uplift", "m");
    table << '\n' << std::setprecision(9);
    for (std::size_t row = 0; row < record.time_s.size(); ++row)
        for (std::size_t i = 0; i < columns.size(); ++i)
            table << columns[i]->at(row) << (i + 1 < columns.size() ? ',' : '\n');
    std::ofstream sidecar("record.toml", std::ios::binary);
    sidecar << std::setprecision(9) << "schema = \"pantocheck.record/1\"\ncase = " << quote(case_["id"].characters)
            << "\ncase_digest = " << quote(case_["case_digest"].characters) << "\nfile = \"record.csv\"\nspeed_km_h = "
            << double(case_["speed_km_h"]) << "\npantographs = " << record.force_N.size() << "\nevaluated_m = ["
            << join(case_["evaluated_m"].numbers()) << "]\nfilter_applied_Hz = \"none\"\n";
    if (!record.support_position_m.empty())
        sidecar << "support_position_m = [" << join(record.support_position_m) << "]\n";
    sidecar << system << "[start]\nplace_m = " << record.start.place_m << "\nramp_m = " << record.start.ramp_m
            << "\nstate = " << quote(record.start.state) << "\n[run]\nwall_s = " << wall_s
            << "\nsimulated_s = " << record.time_s.back() << "\ndt_s = " << record.dt_s
            << "\nelement_m = " << record.element_m << '\n';
}

/// Answer to a message `run`, without its number.
inline std::string run(
    const Json& case_, const std::string& system, const std::function<Record(const Json&)>& simulate,
    const std::set<std::string>& features) {
    try {
        for (const Json& feature : case_["features"].items)
            if (!features.count(feature.characters)) throw Skip("the simulator neglects " + feature.characters);
        const auto begin = std::chrono::steady_clock::now();
        const Record record = simulate(case_);
        const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
        write_record(record, case_, system, wall.count());
        const std::string notes = record.note.empty() ? "" : quote(record.note);
        auto describe = [](const std::string& name) {
            return "{\"file\": " + quote(name) + ", \"sha256\": \"" + sha256(read_file(name)) + "\"}";
        };
        return "\"message\": \"delivered\", \"record\": {\"sidecar\": " + describe("record.toml") +
               ", \"table\": " + describe("record.csv") + "}, \"notes\": [" + notes + "]";
    } catch (const Skip& reason) {
        return "\"message\": \"skipped\", \"reason\": " + quote(reason.what());
    } catch (const std::exception& error) {
        return "\"message\": \"errored\", \"reason\": " + quote(error.what());
    }
}

/// Answer the messages of Pantocheck until it says stop. Use std::cerr for a log.
inline int serve(
    const std::string& name, const std::string& version, const std::function<Record(const Json&)>& simulate,
    const std::set<std::string>& features) {
    std::string listed;
    for (const std::string& feature : features) listed += (listed.empty() ? "" : ", ") + quote(feature);
    const std::string system = "[system]\nname = " + quote(name) + "\nversion = " + quote(version) + "\n";
    for (std::string line; std::getline(std::cin, line);) {
        const Json message = JsonParser(line).parse();
        const std::string kind = message["message"].characters;
        if (kind == "stop") break;
        if (kind == "start") {
            std::cout << "{\"message\": \"started\", \"protocol\": \"pantocheck.command/1\", \"name\": " << quote(name)
                      << ", \"version\": " << quote(version) << ", \"features\": [" << listed << "]}" << std::endl;
        } else {
            const std::string answer = run(message["case"], system, simulate, features);
            std::cout << "{\"id\": " << int(double(message["id"])) << ", " << answer << "}" << std::endl;
        }
    }
    return 0;
}

}  // namespace pantocheck
