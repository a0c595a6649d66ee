// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// A recorded session, edited inside HDF5 as in hdf5_edits.hpp: every query of a reader.
#include <unistd.h>

#include <fstream>
#include <iterator>

#include "common/session/opinions.hpp"
#include "common/session/reader.hpp"
#include "common/session/repair/check.hpp"
#include "common/session/repair/damage.hpp"
#include "common/session/writer.hpp"
#include "hdf5_edits.hpp"
#include "tests/unit/common/session/sample.hpp"

namespace eti::session {
namespace {

/// A short session with one of everything.
std::vector<char> recorded() {
    const std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("fuzz-" + std::to_string(::getpid()) + ".eti.h5");
    std::filesystem::remove(path);
    {
        SessionWriter writer(path, sample::info(), sample::scene(6), {});
        for (std::uint64_t i = 0; i < 20; ++i) {
            writer.push(sample::step(i));
            if (i % 5 == 0) {
                writer.push(sample::deformation(i));
                writer.push(sample::fluid(i));
                writer.push(sample::event(i));
                writer.push(sample::annotation(i));
                writer.push(sample::state(i));
                writer.push(CommandRecord{i * sample::step_ns, i, "jaw_opening", 0.25, "desk", 1});
            }
        }
        writer.push(SummaryRecord{});
        fuzz::require(writer.close(), "the sound session cannot be written");
    }
    std::ifstream in(path, std::ios::binary);
    std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
    std::filesystem::remove(path);
    return bytes;
}

void read_all(const std::filesystem::path& path) {
    const SessionReader reader(path);
    (void)reader.duration();
    const auto each = [&](const auto& read) { fuzz::read_or_refuse<hdf5::Error>(path.string(), read); };
    each([&] { (void)reader.scene(); });
    each([&] { (void)reader.steps(); });
    each([&] { (void)reader.commands(); });
    each([&] { (void)reader.states(); });
    each([&] { (void)reader.deformations(); });
    each([&] { (void)reader.fluids(); });
    each([&] { (void)reader.events(); });
    each([&] { (void)reader.annotations(); });
    each([&] { (void)reader.summaries(); });
    each([&] { (void)reader.series("metrics"); });
    each([&] { (void)read_damage(reader.root()); });
    each([&] { (void)read_ratings(reader.root()); });
    each([&] { (void)read_answers(reader.root()); });
}

}  // namespace
}  // namespace eti::session

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eti;
    hdf5::prepare_thread();
    static const std::vector<char> sound = session::recorded();
    static const fuzz::MemoryFile file;
    const std::filesystem::path path = file.path();
    fuzz::hold_changed(file, sound, data, size);
    fuzz::read_or_refuse<hdf5::Error>(path.string(), [&] { session::read_all(path); });
    fuzz::read_or_refuse<hdf5::Error>(path.string(), [&] { (void)session::check(path); });
    return 0;
}
