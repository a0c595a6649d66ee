// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/session/opinions.hpp"

#include <spdlog/fmt/chrono.h>
#include <spdlog/fmt/fmt.h>
#include <algorithm>
#include <chrono>
#include <functional>

#include "common/hdf5/file.hpp"
#include "common/process/files/atomic_file_writer.hpp"
#include "common/session/reader.hpp"
#include "common/session/repair/recording_lock.hpp"
#include "common/session/repair/superblock.hpp"
#include "common/session/text_columns.hpp"

namespace eti::session {

namespace {

using hdf5::Group;

constexpr TextColumn<Rating> rating_columns[] = {
    {"rater", "rater", &Rating::rater},
    {"item", "rated item", &Rating::item},
    {"given", "when, UTC", &Rating::given},
};

constexpr TextColumn<Answer> answer_columns[] = {
    {"form", "name of the form", &Answer::form},
    {"question", "name of the question in it", &Answer::question},
    {"text", "the question as it was asked", &Answer::text},
    {"answer", "a score from 1 (worst) to 5 (best), yes or no, or words", &Answer::answer},
    {"given", "when, UTC", &Answer::given},
};

void write_ratings(const Group& root, const std::vector<Rating>& ratings) {
    const Group group = root.create(ratings_group);
    write_text_columns(group, ratings, rating_columns);
    std::vector<std::uint8_t> scores;
    for (const Rating& rating : ratings) {
        scores.push_back(rating.score);
    }
    group.write<std::uint8_t>("score", scores, {scores.size()}, {"1", "1 (worst) to 5 (best)"});
}

void require_amendable(const std::filesystem::path& file) {
    const SessionReader reader(file);
    if (reader.is_being_recorded()) {
        throw hdf5::Error(fmt::format(
            "{}: a running program is recording to this file; expected a finished one: end the session first",
            file.string()));
    }
    const auto superblock = read_superblock(file);
    if (reader.rows_in_tail() > 0 || (superblock && superblock->marked_open)) {
        throw hdf5::Error(
            fmt::format("{}: the recording program was killed, and nothing can be added to its file in this "
                        "state; first run: eti-review check --repair {}",
                        file.string(), file.string()));
    }
}

/// Changes a copy, which replaces the file when it is complete.
void amend(const std::filesystem::path& file, const std::function<void(const Group& root)>& change) {
    require_amendable(file);
    AtomicFileWriter copy(file);
    try {
        std::filesystem::copy_file(file, copy.path());
        hdf5::File open = hdf5::File::open(copy.path(), hdf5::Access::modify, file);
        change(open.root());
        open.close();
        copy.finish();
    } catch (const std::filesystem::filesystem_error& error) {
        throw hdf5::Error(
            fmt::format("{}: cannot be changed: {}; the folder needs room for a copy and must be "
                        "writable",
                        file.string(), error.code().message()));
    }
}

void remove_group(const Group& root, const char* name) {
    if (root.has(name) && H5Ldelete(root.id(), name, H5P_DEFAULT) < 0) {
        throw hdf5::Error(fmt::format("{}: cannot be replaced: {}", root.at(name), hdf5::last_error()));
    }
}

/// Newer records replace those for which `same` is true.
template <class Record, class Same>
std::vector<Record> merged(std::vector<Record> records, const std::vector<Record>& newer, const Same& same) {
    for (const Record& one : newer) {
        std::erase_if(records, [&](const Record& old) { return same(old, one); });
        records.push_back(one);
    }
    return records;
}

}  // namespace

std::vector<Rating> read_ratings(const Group& root) {
    if (!root.has(ratings_group)) {
        return {};
    }
    const Group group = root.open(ratings_group);
    std::vector<Rating> ratings = read_text_columns(group, rating_columns);
    const auto scores = group.read<std::uint8_t>("score", {ratings.size()}).values;
    for (std::size_t i = 0; i < ratings.size(); ++i) {
        ratings[i].score = scores[i];
    }
    return ratings;
}

std::vector<Answer> read_answers(const Group& root) {
    return root.has(answers_group) ? read_text_columns(root.open(answers_group), answer_columns)
                                   : std::vector<Answer>();
}

void add_ratings(const std::filesystem::path& file, const std::vector<Rating>& ratings) {
    amend(file, [&](const Group& root) {
        const auto all = merged(read_ratings(root), ratings, [](const Rating& a, const Rating& b) {
            return a.rater == b.rater && a.item == b.item;
        });
        remove_group(root, ratings_group);
        write_ratings(root, all);
    });
}

void add_answers(const std::filesystem::path& file, const std::vector<Answer>& answers) {
    amend(file, [&](const Group& root) {
        const auto all = merged(read_answers(root), answers, [](const Answer& a, const Answer& b) {
            return a.form == b.form && a.question == b.question;
        });
        remove_group(root, answers_group);
        write_text_columns(root.create(answers_group), all, answer_columns);
    });
}

std::string utc_now() {
    return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}",
                       fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
}

}  // namespace eti::session
