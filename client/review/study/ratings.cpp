// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/review/study/ratings.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "client/review/output.hpp"
#include "common/session/reader.hpp"

namespace eti::review {

namespace {

constexpr std::size_t longest_name = 40;

std::string share(double value) {
    return std::isfinite(value) ? fmt::format("{:.2f}", value) : "-";
}

std::string with_interval(double value, const Interval& interval) {
    return fmt::format("{} ({} to {})", share(value), share(interval.low), share(interval.high));
}

}  // namespace

void require_name(const std::string& option, const std::string& name) {
    const bool clean = std::ranges::none_of(name, [](unsigned char c) { return c < 0x20 || c == 0x7f; });
    if (name.empty() || name.size() > longest_name || !clean) {
        throw RatingError(fmt::format("{}: {} bytes{}; expected 1 to {}, without control characters", option,
                                      name.size(), clean ? "" : " with control characters", longest_name));
    }
}

session::Rating parse_rating(const std::string& text, const std::string& rater) {
    const std::size_t equals = text.rfind('=');
    const std::string item = text.substr(0, equals);
    const std::string score = equals == std::string::npos ? "" : text.substr(equals + 1);
    const bool word = !item.empty() && item.size() <= longest_name &&
                      std::ranges::all_of(
                          item, [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; });
    if (!word || score.size() != 1 || score[0] < '0' + session::lowest_score ||
        score[0] > '0' + session::highest_score) {
        throw RatingError(
            fmt::format("--score '{}': expected ITEM=SCORE, an item of letters, digits, _ and -, and a score "
                        "from {} (worst) to {} (best), such as overall=4",
                        text.substr(0, 60), session::lowest_score, session::highest_score));
    }
    return {rater, item, static_cast<std::uint8_t>(score[0] - '0'), session::utc_now()};
}

std::vector<ItemAgreement> rater_agreement(const std::vector<std::filesystem::path>& files, double level) {
    // Scores by rater, for each item and file.
    std::map<std::string, std::vector<std::map<std::string, double>>> items;
    std::map<std::string, std::set<std::string>> raters;
    for (const std::filesystem::path& file : files) {
        std::map<std::string, std::map<std::string, double>> here;
        for (const session::Rating& rating : session::read_ratings(session::SessionReader(file).root())) {
            here[rating.item][rating.rater] = rating.score;
            raters[rating.item].insert(rating.rater);
        }
        for (auto& [item, scores] : here) {
            items[item].push_back(std::move(scores));
        }
    }
    if (items.empty()) {
        throw RatingError(
            fmt::format("{} files contain no rating; add ratings with: eti-review rate FILE --rater NAME "
                        "--score ITEM=1..5",
                        files.size()));
    }
    std::vector<ItemAgreement> out;
    for (const auto& [item, sessions] : items) {
        ItemAgreement one{item, {raters[item].begin(), raters[item].end()}, 0, 0, {}};
        std::vector<std::vector<double>> table;
        for (const auto& scores : sessions) {
            if (scores.size() < one.raters.size()) {
                ++one.left_out;
                continue;
            }
            auto& row = table.emplace_back();
            for (const auto& [rater, score] : scores) {
                row.push_back(score);
            }
        }
        one.sessions = table.size();
        one.value = agreement(table, level);
        out.push_back(std::move(one));
    }
    return out;
}

std::string to_table(const std::vector<ItemAgreement>& items) {
    std::string out = fmt::format("{:<24}{:>7}{:>10}  {:<24}{:<24}\n", "Item", "raters", "sessions",
                                  "ICC(2,1)", "ICC(2,k)");
    for (const ItemAgreement& one : items) {
        out += fmt::format("{:<24}{:>7}{:>10}  {:<24}{:<24}\n", one.item, one.raters.size(), one.sessions,
                           with_interval(one.value.single, one.value.single_interval),
                           with_interval(one.value.mean, one.value.mean_interval));
        if (one.left_out > 0) {
            out += fmt::format("  excluded: {} sessions without a score by each rater of the item\n",
                               one.left_out);
        }
        if (!std::isfinite(one.value.single)) {
            out += "  no value: requires two raters, two sessions rated by both, and scores that differ\n";
        }
    }
    return out + "ICC: agreement of one rater (2,1) and of the raters' mean (2,k), with 95 % intervals.\n";
}

nlohmann::ordered_json to_json(const std::vector<ItemAgreement>& items) {
    auto out = nlohmann::ordered_json::array();
    for (const ItemAgreement& one : items) {
        const Agreement& value = one.value;
        out.push_back(
            {{"item", one.item},
             {"raters", one.raters},
             {"sessions", one.sessions},
             {"left_out", one.left_out},
             {"icc_2_1", number_or_null(value.single)},
             {"icc_2_1_interval",
              {number_or_null(value.single_interval.low), number_or_null(value.single_interval.high)}},
             {"icc_2_k", number_or_null(value.mean)},
             {"icc_2_k_interval",
              {number_or_null(value.mean_interval.low), number_or_null(value.mean_interval.high)}}});
    }
    return out;
}

}  // namespace eti::review
