// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gmock/gmock.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <fstream>
#include <thread>

#include "common/session/cell.hpp"
#include "common/session/layout.hpp"
#include "common/session/reader.hpp"
#include "common/session/repair/check.hpp"
#include "common/session/repair/damage.hpp"
#include "common/session/repair/superblock.hpp"
#include "common/session/writer.hpp"
#include "tests/support/error_of.hpp"
#include "tests/support/eventually.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/common/session/sample.hpp"

namespace eti::session {
namespace {

class Session : public test::ScratchFolderTest {
  protected:
    const std::filesystem::path path = folder / "run.eti.h5";
};

/// Records `steps` steps with a deformation every twelfth and a few of each other record.
void record(const std::filesystem::path& path, std::uint64_t steps) {
    SessionWriter::Settings settings;
    settings.on_error = [](const std::string& text) { ADD_FAILURE() << text; };
    settings.wait_when_full = true;
    SessionWriter writer(path, sample::info(), sample::scene(), settings);
    for (std::uint64_t i = 0; i < steps; ++i) {
        if (i % 100 == 0) {
            writer.push(CommandRecord{i * sample::step_ns, i, "jaw_opening", 0.25 * static_cast<double>(i),
                                      "trainee", static_cast<std::uint32_t>(i)});
            writer.push(sample::event(i));
            writer.push(sample::annotation(i));
        }
        if (i % 12 == 0) {
            writer.push(sample::deformation(i));
            writer.push(sample::fluid(i));
        }
        writer.push(sample::step(i));
    }
    const StepRecord last = sample::step(steps);
    writer.push(SummaryRecord{1, {false, "the tube went into the oesophagus"}, last.metrics});
    writer.push(SummaryRecord{0, {false, "so far"}, {}});
    writer.push(SummaryRecord{2, {true, "the trachea was intubated"}, {}});
    writer.push(SummaryRecord{0, {true, "the trachea was intubated"}, last.metrics});
    EXPECT_TRUE(writer.close());
}

/// Bit for bit, so that NaN equals itself.
bool same(const StepRecord& a, const StepRecord& b) {
    bool equal = a.tube_nodes == b.tube_nodes;
    step_columns(0)([&](const std::string&, const hdf5::Label&, auto field, std::size_t) {
        using Field = std::decay_t<decltype(field(a))>;
        if constexpr (!std::is_same_v<Field, std::vector<Vec3f>>) {
            std::vector<std::byte> left(Cell<Field>::bytes(0)), right(left.size());
            Cell<Field>::pack(field(a), 0, left.data());
            Cell<Field>::pack(field(b), 0, right.data());
            equal = equal && left == right;
        }
    });
    return equal;
}

TEST_F(Session, DrySceneHasNoFluidGroup) {
    SceneRecord dry = sample::scene();
    dry.liquid = false;
    SessionWriter writer(path, sample::info(), dry, {});
    writer.push(sample::step(0));
    EXPECT_TRUE(writer.close());
    const SessionReader reader(path);
    EXPECT_FALSE(reader.root().has("fluid"));
    EXPECT_TRUE(reader.fluids().empty());
    EXPECT_TRUE(check(path).is_valid());
}

TEST_F(Session, OlderFileLacksNewerMeasures) {
    record(path, 10);
    {
        const hdf5::File file = hdf5::File::open(path, hdf5::Access::modify);
        ASSERT_GE(H5Ldelete(file.root().id(), "metrics/tube_force_now", H5P_DEFAULT), 0);
    }
    const auto steps = SessionReader(path).steps();
    ASSERT_EQ(steps.size(), 10u);
    EXPECT_TRUE(std::isnan(steps[5].measures.tube_force_n));
    EXPECT_EQ(steps[5].measures.gum_force_n, sample::step(5).measures.gum_force_n);
}

TEST_F(Session, RecordingIsReadBackBitIdentical) {
    constexpr std::uint64_t steps = 1000;
    record(path, steps);
    const SessionReader reader(path);
    EXPECT_TRUE(reader.finished());
    EXPECT_FALSE(reader.is_being_recorded());
    EXPECT_EQ(reader.lost_records(), 0u);
    EXPECT_DOUBLE_EQ(reader.duration(), static_cast<double>((steps - 1) * sample::step_ns) * 1e-9);

    const SessionInfo info = sample::info();
    EXPECT_EQ(reader.info().scenario_text, info.scenario_text);
    EXPECT_EQ(reader.info().session, info.session);
    EXPECT_EQ(reader.info().seed, info.seed);
    EXPECT_EQ(reader.info().more, info.more);

    const auto read = reader.steps();
    ASSERT_EQ(read.size(), steps);
    for (std::uint64_t i = 0; i < steps; ++i) {
        ASSERT_TRUE(same(read[i], sample::step(i))) << "step " << i;
    }
    const auto commands = reader.commands();
    ASSERT_EQ(commands.size(), 10u);
    EXPECT_EQ(commands[3].step, 300u);
    EXPECT_EQ(commands[3].kind, "jaw_opening");
    EXPECT_EQ(commands[3].sender, "trainee");
    EXPECT_EQ(commands[3].value, 75.0);
    EXPECT_EQ(commands[3].id, 300u);
    const auto events = reader.events();
    ASSERT_EQ(events.size(), 10u);
    EXPECT_EQ(events[9].text, "event of step 900");
    const auto deformations = reader.deformations();
    ASSERT_EQ(deformations.size(), (steps + 11) / 12);
    for (std::size_t i = 0; i < deformations.size(); ++i) {
        const DeformationRecord expected = sample::deformation(12 * i);
        ASSERT_EQ(deformations[i].time_ns, expected.time_ns);
        ASSERT_EQ(deformations[i].frame, expected.frame);
        for (std::size_t k = 0; k < expected.pose.size(); ++k) {
            ASSERT_EQ(deformations[i].pose[k].centre, expected.pose[k].centre);
            ASSERT_EQ(deformations[i].pose[k].rotation.coeffs(), expected.pose[k].rotation.coeffs());
        }
    }
    const auto fluids = reader.fluids();
    ASSERT_EQ(fluids.size(), (steps + 11) / 12);
    for (std::size_t i = 0; i < fluids.size(); ++i) {
        ASSERT_EQ(fluids[i].time_ns, sample::fluid(12 * i).time_ns);
        ASSERT_EQ(fluids[i].position, sample::fluid(12 * i).position);
    }
    const auto annotations = reader.annotations();
    ASSERT_EQ(annotations.size(), 10u);
    for (std::size_t i = 0; i < annotations.size(); ++i) {
        const AnnotationRecord expected = sample::annotation(100 * i);
        EXPECT_EQ(annotations[i].time_ns, expected.time_ns);
        EXPECT_EQ(annotations[i].kind, expected.kind);
        EXPECT_EQ(annotations[i].sender, expected.sender);
        EXPECT_EQ(annotations[i].text, expected.text);
        EXPECT_EQ(annotations[i].object, expected.object);
        EXPECT_EQ(annotations[i].place, expected.place);
        EXPECT_EQ(annotations[i].position, expected.position);
    }
    const auto summaries = reader.summaries();
    ASSERT_EQ(summaries.size(), 3u);
    EXPECT_EQ(summaries[0].attempt, 0u);
    EXPECT_TRUE(summaries[0].outcome.success) << "the later record of an attempt counts";
    EXPECT_FALSE(summaries[1].outcome.success);
    EXPECT_EQ(summaries[1].outcome.reason, "the tube went into the oesophagus");
    EXPECT_EQ(summaries[1].metrics.time_s, sample::step(steps).metrics.time_s);

    const SceneRecord scene = reader.scene(), expected = sample::scene();
    EXPECT_EQ(scene.frame_rest_centre, expected.frame_rest_centre);
    ASSERT_EQ(scene.surfaces.size(), 2u);
    EXPECT_EQ(scene.surfaces[1].name, "tongue");
    EXPECT_EQ(scene.surfaces[1].mesh.vertices, expected.surfaces[1].mesh.vertices);
    EXPECT_EQ(scene.surfaces[1].triangle_tissue, expected.surfaces[1].triangle_tissue);
    EXPECT_EQ(scene.surfaces[1].skin[7].frame, expected.surfaces[1].skin[7].frame);
    EXPECT_EQ(scene.surfaces[1].skin[7].weight, expected.surfaces[1].skin[7].weight);
    EXPECT_EQ(scene.landmarks[1].name, "carina");
    EXPECT_EQ(scene.blade, "miller_1");
    EXPECT_EQ(scene.blade_length, 0.125f);
    EXPECT_EQ(scene.weight, 3.5f);
    const Definitions& said = expected.definitions;
    EXPECT_EQ(scene.definitions.version, 7u);
    ASSERT_EQ(scene.definitions.metrics.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        const auto& [key, unit, run, definition, aim] = scene.definitions.metrics[i];
        EXPECT_EQ(key, said.metrics[i].key);
        EXPECT_EQ(unit, said.metrics[i].unit);
        EXPECT_EQ(run, said.metrics[i].run);
        EXPECT_EQ(definition, said.metrics[i].definition);
        EXPECT_EQ(aim, said.metrics[i].aim);
    }
    ASSERT_EQ(scene.definitions.thresholds.size(), 2u);
    EXPECT_EQ(scene.definitions.thresholds[0].name, "gate_slack");
    EXPECT_EQ(scene.definitions.thresholds[0].value, 0.002);
    EXPECT_EQ(scene.definitions.thresholds[1].unit, "1/s");
    EXPECT_EQ(scene.definitions.thresholds[1].meaning, "");
    EXPECT_EQ(scene.tube_outer_diameter, expected.tube_outer_diameter);
    EXPECT_TRUE(check(path).is_valid());
}

TEST_F(Session, RepairKeepsIntactData) {
    constexpr std::uint64_t steps = 1000;
    record(path, steps);
    haddr_t address = HADDR_UNDEF;
    hsize_t bytes = 0;
    {
        const hdf5::File file = hdf5::File::open(path, hdf5::Access::read);
        const hdf5::Handle series(H5Dopen2(file.id(), "metrics/gum_force_now", H5P_DEFAULT), H5Dclose);
        const hsize_t first = 0;
        unsigned mask = 0;
        ASSERT_GE(H5Dget_chunk_info_by_coord(series.get(), &first, &mask, &address, &bytes), 0);
    }
    {
        std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
        file.seekg(static_cast<std::streamoff>(address + bytes / 2));
        const int byte = file.get();
        file.seekp(static_cast<std::streamoff>(address + bytes / 2));
        file.put(static_cast<char>(byte ^ 1));
    }
    EXPECT_FALSE(check(path).is_valid());
    EXPECT_FALSE(repair(path).empty());
    EXPECT_TRUE(check(path).is_valid());
    const SessionReader reader(path);
    EXPECT_TRUE(reader.finished());
    const auto damage = read_damage(reader.root());
    ASSERT_EQ(damage.size(), 1u);
    EXPECT_EQ(damage[0].path, "metrics/gum_force_now");
    EXPECT_EQ(damage[0].first, 0u);
    EXPECT_EQ(damage[0].count, step_chunk);
    const auto read = reader.steps();
    ASSERT_EQ(read.size(), steps);
    for (std::uint64_t i = 0; i < steps; ++i) {
        StepRecord expected = sample::step(i);
        if (i < step_chunk) {
            EXPECT_TRUE(std::isnan(read[i].measures.gum_force_n));
            expected.measures.gum_force_n = read[i].measures.gum_force_n;
        }
        ASSERT_TRUE(same(read[i], expected)) << "step " << i;
    }
    EXPECT_EQ(reader.commands().size(), 10u);
    EXPECT_EQ(reader.events().size(), 10u);
    EXPECT_EQ(reader.deformations().size(), (steps + 11) / 12);
    EXPECT_EQ(reader.fluids().size(), (steps + 11) / 12);
    EXPECT_EQ(reader.summaries().size(), 3u);
    const auto annotations = reader.annotations();
    ASSERT_EQ(annotations.size(), 10u);
    for (std::size_t i = 0; i < annotations.size(); ++i) {
        EXPECT_EQ(annotations[i].text, sample::annotation(100 * i).text);
        EXPECT_EQ(annotations[i].place, sample::annotation(100 * i).place);
    }
}

TEST_F(Session, EmptySessionIsValid) {
    { SessionWriter writer(path, sample::info(), sample::scene(), {}); }
    const SessionReader reader(path);
    EXPECT_TRUE(reader.finished());
    EXPECT_EQ(reader.duration(), 0.0);
    EXPECT_TRUE(reader.steps().empty());
    EXPECT_TRUE(reader.summaries().empty());
    EXPECT_TRUE(check(path).is_valid());
}

TEST_F(Session, DatasetsHaveUnitMeaningAndCompression) {
    record(path, 200);
    const hdf5::File file = hdf5::File::open(path, hdf5::Access::read);
    struct Visit {
        hid_t root;
        int data_sets = 0;
    } visit{file.id()};
    const auto look = [](hid_t, const char* name, const H5O_info_t* info, void* data) -> herr_t {
        auto& seen = *static_cast<Visit*>(data);
        if (info->type == H5O_TYPE_DATASET) {
            ++seen.data_sets;
            const hdf5::Handle set(H5Dopen2(seen.root, name, H5P_DEFAULT), H5Dclose);
            EXPECT_GT(H5Aexists(set.get(), "units"), 0) << name;
            EXPECT_GT(H5Aexists(set.get(), "description"), 0) << name;
            const hdf5::Handle creation(H5Dget_create_plist(set.get()), H5Pclose);
            if (std::string_view(name).starts_with("tail/")) {
                return 0;  // written in place
            }
            EXPECT_EQ(H5Pget_layout(creation.get()), H5D_CHUNKED) << name;
            const int filters = H5Pget_nfilters(creation.get());
            const bool series = !std::string_view(name).starts_with("scene/");
            EXPECT_EQ(filters, series ? 3 : 2)
                << name << ": shuffle and deflate, and a checksum of each chunk";
        }
        return 0;
    };
    H5Ovisit2(file.id(), H5_INDEX_NAME, H5_ITER_NATIVE, look, &visit, H5O_INFO_BASIC);
    EXPECT_GT(visit.data_sets, 80);
}

TEST_F(Session, SeriesOfAGroupShareItsTimeAxis) {
    record(path, 200);
    const SessionReader reader(path);
    for (const std::string group : {"inputs", "tools", "skeleton", "metrics"}) {
        const auto series = reader.series(group);
        ASSERT_GE(series.size(), 3u) << group;
        EXPECT_EQ(series[0].path, group + "/time_ns");
        EXPECT_EQ(series[0].units, "ns");
        for (const Series& one : series) {
            EXPECT_EQ(one.rows(), 200u) << one.path;
        }
    }
}

TEST_F(Session, IsReadWhileItIsRecorded) {
    SessionWriter::Settings settings;
    settings.wait_when_full = true;
    SessionWriter writer(path, sample::info(), sample::scene(), settings);
    for (std::uint64_t i = 0; i < 500; ++i) {
        writer.push(sample::step(i));
    }
    // Full chunks are written to their series at once; the rest is buffered.
    constexpr std::size_t chunked = 500 / step_chunk * step_chunk;
    EXPECT_TRUE(test::eventually([&] { return SessionReader(path).steps().size() >= chunked; }));
    const SessionReader reader(path);
    EXPECT_TRUE(reader.is_being_recorded());
    EXPECT_FALSE(reader.finished());
    EXPECT_EQ(reader.steps().size(), chunked);
    EXPECT_TRUE(check(path).is_valid());
    EXPECT_THROW((void)repair(path), hdf5::Error) << "would change a file under its writer";
    EXPECT_TRUE(writer.close());
    EXPECT_TRUE(SessionReader(path).finished());
}

TEST_F(Session, TailHoldsSamplesNotYetInASeries) {
    const std::filesystem::path left_behind = path.string() + ".left";
    constexpr std::uint64_t all = 300, fewer_than_a_chunk = 20;
    {
        SessionWriter writer(path, sample::info(), sample::scene(), {});
        for (std::uint64_t i = 0; i < all; ++i) {
            writer.push(sample::step(i));
        }
        writer.push(sample::deformation(1));
        writer.push(sample::fluid(50));
        writer.push(sample::annotation(400));
        writer.push(sample::event(7));
        std::this_thread::sleep_for(std::chrono::milliseconds(400));
        // A killed writer leaves the file as another process sees it now.
        std::filesystem::copy_file(path, left_behind);
    }
    const auto look = [&](const SessionReader& reader) {
        EXPECT_FALSE(reader.finished());
        const auto steps = reader.steps();
        ASSERT_EQ(steps.size(), all);
        EXPECT_EQ(steps.back().proxy.translation, sample::step(all - 1).proxy.translation);
        for (const MetricField& field : metric_fields) {
            EXPECT_EQ(steps.back().metrics.*field.value, sample::step(all - 1).metrics.*field.value);
        }
        ASSERT_EQ(reader.deformations().size(), 1u);
        EXPECT_EQ(reader.deformations()[0].frame, sample::deformation(1).frame);
        ASSERT_EQ(reader.fluids().size(), 1u);
        EXPECT_EQ(reader.fluids()[0].position, sample::fluid(50).position);
        ASSERT_EQ(reader.annotations().size(), 1u);
        EXPECT_EQ(reader.annotations()[0].position, sample::annotation(400).position);
        ASSERT_EQ(reader.events().size(), 1u);
        EXPECT_EQ(reader.events()[0].text, "event of step 7");
    };
    {
        const SessionReader reader(left_behind);
        EXPECT_GT(reader.rows_in_tail(), fewer_than_a_chunk);
        look(reader);
    }
    EXPECT_FALSE(check(left_behind).is_valid());
    EXPECT_FALSE(repair(left_behind).empty());
    const SessionReader repaired(left_behind);
    EXPECT_EQ(repaired.rows_in_tail(), 0u);
    EXPECT_FALSE(repaired.root().has("tail"));
    look(repaired);
    EXPECT_TRUE(check(left_behind).is_valid());
    std::filesystem::remove(left_behind);
}

TEST_F(Session, FullQueueDropsRecordsAndWarns) {
    std::atomic<int> warnings{0};
    SessionWriter::Settings settings;
    settings.waiting_steps = 4;
    settings.on_warning = [&](const std::string& text) {
        EXPECT_NE(text.find("waiting_steps"), std::string::npos) << text;
        ++warnings;
    };
    SessionWriter writer(path, sample::info(), sample::scene(), settings);
    // 1000 pushes take about a millisecond; the writer polls its queues every 20 ms.
    std::uint64_t taken = 0;
    for (std::uint64_t i = 0; i < 1000; ++i) {
        taken += writer.push(sample::step(i)) ? 1 : 0;
    }
    EXPECT_LT(taken, 1000u);
    EXPECT_EQ(writer.lost(), 1000u - taken);
    EXPECT_FALSE(writer.close()) << "not everything is in the file";
    EXPECT_GE(warnings, 1);
    const SessionReader reader(path);
    EXPECT_EQ(reader.steps().size(), taken);
    EXPECT_EQ(reader.lost_records(), 1000u - taken);
    ASSERT_FALSE(reader.events().empty());
    EXPECT_EQ(reader.events()[0].kind, "recording");
}

// As by h5py.File(path, "w"), which the library's lock does not refuse.
TEST_F(Session, OverwrittenFileEndsRecordingWithoutHang) {
    const std::filesystem::path other = folder / "other.eti.h5";
    record(other, 10);
    for (const bool at_end : {false, true}) {
        std::filesystem::remove(path);
        std::atomic<int> errors{0};
        SessionWriter::Settings settings;
        settings.on_error = [&](const std::string& text) {
            EXPECT_NE(text.find("another program has overwritten the file"), std::string::npos) << text;
            EXPECT_NE(text.find("swmr=True"), std::string::npos) << text;
            ++errors;
        };
        SessionWriter writer(path, sample::info(), sample::scene(), settings);
        for (std::uint64_t i = 0; i < 400; ++i) {
            writer.push(sample::step(i));
        }
        ASSERT_TRUE(test::eventually([&] { return SessionReader(path).steps().size() == 400; }));
        std::filesystem::copy_file(other, path, std::filesystem::copy_options::overwrite_existing);
        if (!at_end) {
            EXPECT_TRUE(test::eventually([&] { return writer.failed(); }));
        }
        EXPECT_FALSE(writer.close());
        EXPECT_EQ(errors, 1);
    }
}

TEST_F(Session, ExistingAndUnwritablePathsAreRefused) {
    std::ofstream(path) << "precious";
    EXPECT_THROW(SessionWriter(path, sample::info(), sample::scene(), {}), hdf5::Error);
    EXPECT_EQ(std::filesystem::file_size(path), 8u);
    EXPECT_THAT(eti::test::error_of<hdf5::Error>([&] {
                    const SessionWriter writer(folder / "missing" / "run.eti.h5", sample::info(),
                                               sample::scene(), {});
                }),
                ::testing::HasSubstr("No such file or directory"));
}

TEST_F(Session, TextsAreCutBetweenCharacters) {
    const std::string text = std::string(text_bytes - 1, 'a') + "µ";  // two bytes, of which one fits
    {
        SessionWriter writer(path, sample::info(), sample::scene(), {});
        writer.push(EventRecord{0, "note", text});
    }
    const auto events = SessionReader(path).events();
    ASSERT_EQ(events.size(), 1u);
    EXPECT_EQ(events[0].text, std::string(text_bytes - 1, 'a'));
}

TEST_F(Session, ForeignFilesAreRefusedByName) {
    const auto refusal = [&] {
        return eti::test::error_of<hdf5::Error>([&] { const SessionReader reader(path); });
    };
    EXPECT_NE(refusal().find("no such file"), std::string::npos) << refusal();
    EXPECT_EQ(refusal().find("--repair"), std::string::npos) << "what is not there cannot be mended";
    std::ofstream(path) << "";
    EXPECT_NE(refusal().find("empty"), std::string::npos) << refusal();
    std::ofstream(path) << std::string(5000, 'x');
    EXPECT_NE(refusal().find("not an HDF5 file"), std::string::npos) << refusal();
    std::filesystem::remove(path);
    hdf5::File::create(path).close();
    EXPECT_NE(refusal().find("not a session"), std::string::npos) << refusal();
}

TEST(MetadataChecksum, MatchesTheAuthorsTestVectors) {
    // lookup3.c, driver5: hashlittle of these texts with initial value 0.
    const std::string text = "Four score and seven years ago";
    EXPECT_EQ(metadata_checksum(reinterpret_cast<const unsigned char*>(text.data()), text.size()),
              0x17770551u);
    EXPECT_EQ(metadata_checksum(nullptr, 0), 0xdeadbeefu);
}

}  // namespace
}  // namespace eti::session
