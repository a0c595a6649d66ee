// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/session/opinions.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <span>

#include "common/session/anonymise.hpp"
#include "common/session/reader.hpp"
#include "common/session/repair/check.hpp"
#include "common/session/writer.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/common/session/sample.hpp"

namespace eti::session {
namespace {

class Opinions : public test::ScratchFolderTest {
  protected:
    Opinions() {
        SessionInfo info = sample::info();
        info.session = "ward-seven";
        info.more = {{participant_text, "Grace Hopper"},
                     {processor_text, "a processor"},
                     {"scenario_folder", "/home/hopper"}};
        SessionWriter writer(path, info, sample::scene(), {});
        for (std::uint64_t i = 0; i < 200; ++i) {
            writer.push(sample::step(i));
            if (i % 50 == 0) {
                writer.push(sample::fluid(i));
                writer.push(sample::deformation(i));
                writer.push(CommandRecord{i, i, "jaw_opening", 0.5, "desk-ada", 1});
            }
        }
        writer.push(EventRecord{1, "attempt", "attempt 1 began"});
        writer.push(EventRecord{2, "note", "desk-ada: well done, Grace Hopper"});
        writer.push(EventRecord{3, "annotation", "desk-linus points at tongue: here"});
        writer.push(AnnotationRecord{3,
                                     "point",
                                     "desk-linus",
                                     "as desk-ada said",
                                     "tongue",
                                     {{9, 0.2f, 0.5f, 0.0f}},
                                     {Vec3f(1, 2, 3)}});
        SummaryRecord run;
        run.outcome = {true, "it lies well"};
        writer.push(run);
        EXPECT_TRUE(writer.close());
    }

    [[nodiscard]] std::string bytes(const std::filesystem::path& of) const {
        std::ifstream file(of, std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }

    const std::filesystem::path path = folder / "run.eti.h5";
};

TEST_F(Opinions, RatingsAndAnswersAreReplaceable) {
    add_ratings(path, {{"ann", "overall", 3, "t"}, {"ann", "lift", 5, "t"}});
    add_ratings(path, {{"bob", "overall", 1, "t"}, {"ann", "overall", 4, "u"}});
    add_answers(path, {{"f", "look", "Looks real?", "4", "t"}});
    add_answers(path, {{"f", "look", "Looks real?", "5", "u"}, {"f", "missing", "What?", "µ-foam", "u"}});
    const SessionReader reader(path);
    const auto ratings = read_ratings(reader.root());
    ASSERT_EQ(ratings.size(), 3u);
    EXPECT_EQ(ratings[0].item, "lift");
    EXPECT_EQ(ratings[2].rater, "ann");
    EXPECT_EQ(ratings[2].score, 4);
    EXPECT_EQ(ratings[2].given, "u");
    const auto answers = read_answers(reader.root());
    ASSERT_EQ(answers.size(), 2u);
    EXPECT_EQ(answers[0].answer, "5");
    EXPECT_EQ(answers[1].answer, "µ-foam");
    EXPECT_TRUE(check(path).is_valid());
    EXPECT_EQ(reader.steps().size(), 200u);
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        EXPECT_EQ(entry.path(), path) << "left behind";
    }
}

TEST_F(Opinions, FileBeingRecordedIsNotModified) {
    const std::filesystem::path live = folder / "live.eti.h5";
    SessionWriter writer(live, sample::info(), sample::scene(), {});
    writer.push(sample::step(0));
    EXPECT_THROW(add_ratings(live, {{"ann", "overall", 3, "t"}}), hdf5::Error);
    EXPECT_THROW((void)anonymise(live, folder / "out.eti.h5", ""), hdf5::Error);
    EXPECT_FALSE(std::filesystem::exists(folder / "out.eti.h5"));
    EXPECT_TRUE(writer.close());
}

TEST_F(Opinions, SurviveARepair) {
    add_ratings(path, {{"ann", "overall", 3, "t"}});
    // A byte in the middle of the file: some series is damaged, and the file is rewritten.
    const SessionReader before(path);
    {
        const hdf5::Handle set(H5Dopen2(before.root().id(), "tools/proxy_pose", H5P_DEFAULT), H5Dclose);
        unsigned filters = 0;
        haddr_t address = 0;
        hsize_t size = 0;
        const hdf5::Handle space(H5Dget_space(set.get()), H5Sclose);
        hsize_t offset[2];
        ASSERT_GE(H5Dget_chunk_info(set.get(), space.get(), 0, offset, &filters, &address, &size), 0);
        std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(static_cast<std::streamoff>(address + size / 2));
        file.put('\x5a');
        file.put('\xa5');
    }
    ASSERT_FALSE(check(path).is_valid());
    EXPECT_FALSE(repair(path).empty());
    EXPECT_TRUE(check(path).is_valid());
    ASSERT_EQ(read_ratings(SessionReader(path).root()).size(), 1u);
}

TEST_F(Opinions, AnonymousCopyContainsNoNames) {
    add_ratings(path, {{"al", "overall", 3, "2024-02-29T13:00:00Z"}});
    add_answers(path,
                {{"f", "missing", "What is missing?", "Grace Hopper missed foam", "2024-02-29T13:00:00Z"}});
    const std::filesystem::path out = folder / "out.eti.h5";
    const auto gone = anonymise(path, out, "P1");
    EXPECT_FALSE(gone.empty());
    const std::string copy = bytes(out);
    for (const char* name : {"Hopper", "hopper", "ward-seven", "desk-ada", "desk-linus", "2024-02-29"}) {
        EXPECT_EQ(copy.find(name), std::string::npos) << name;
    }
    const SessionReader reader(out);
    EXPECT_EQ(reader.info().more.at(participant_text), "P1");
    EXPECT_EQ(reader.info().more.at(processor_text), "a processor");
    EXPECT_EQ(reader.info().more.size(), 2u);
    EXPECT_EQ(reader.info().scenario_text, sample::info().scenario_text);
    EXPECT_EQ(reader.info().seed, sample::info().seed);
    EXPECT_TRUE(reader.finished());
    const auto events = reader.events();
    EXPECT_EQ(events[0].text, "attempt 1 began");
    EXPECT_EQ(events[1].text, "person 1: well done, person 4");
    EXPECT_EQ(events[2].text, "person 2 points at tongue: here");
    EXPECT_EQ(reader.annotations()[0].sender, "person 2");
    EXPECT_EQ(reader.annotations()[0].text, "as person 1 said");
    EXPECT_EQ(reader.commands()[0].sender, "person 1");
    EXPECT_EQ(read_ratings(reader.root())[0].rater, "person 3");
    EXPECT_EQ(read_answers(reader.root())[0].answer, "person 4 missed foam");
    EXPECT_TRUE(check(out).is_valid());
}

TEST_F(Opinions, AnonymousCopyKeepsSeriesBitIdentical) {
    const std::filesystem::path out = folder / "out.eti.h5";
    (void)anonymise(path, out, "");
    const SessionReader before(path), after(out);
    std::size_t compared = 0;
    for (const char* group : {"inputs", "tools", "contacts", "skeleton", "tissue", "metrics", "deformation",
                              "fluid", "inputs/commands", "events", "annotations", "summary"}) {
        const auto was = before.series(group), is = after.series(group);
        ASSERT_EQ(was.size(), is.size()) << group;
        for (std::size_t i = 0; i < was.size(); ++i) {
            EXPECT_EQ(was[i].path, is[i].path);
            EXPECT_EQ(was[i].units, is[i].units);
            ASSERT_EQ(was[i].values.size(), is[i].values.size()) << was[i].path;
            EXPECT_TRUE(std::ranges::equal(std::as_bytes(std::span(was[i].values)),
                                           std::as_bytes(std::span(is[i].values))))
                << was[i].path;
            compared += was[i].values.size();
        }
    }
    EXPECT_GT(compared, 10000u);
    EXPECT_EQ(before.scene().frame_rest_centre, after.scene().frame_rest_centre);
    EXPECT_EQ(after.info().more.count(participant_text), 0u);
}

TEST_F(Opinions, AnonymousCopyHasNoHdf5Timestamps) {
    const std::filesystem::path out = folder / "out.eti.h5";
    (void)anonymise(path, out, "");
    const SessionReader reader(out);
    int objects = 0;
    const auto look = [](hid_t, const char* name, const H5O_info_t* info, void* count) -> herr_t {
        EXPECT_EQ(info->mtime, 0) << name;
        EXPECT_EQ(info->btime, 0) << name;
        ++*static_cast<int*>(count);
        return 0;
    };
    H5Ovisit2(reader.root().id(), H5_INDEX_NAME, H5_ITER_NATIVE, look, &objects, H5O_INFO_ALL);
    EXPECT_GT(objects, 80);
}

}  // namespace
}  // namespace eti::session
