// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <functional>
#include <limits>
#include <numeric>

#include "common/hdf5/file.hpp"
#include "common/hdf5/packing.hpp"
#include "tests/support/error_of.hpp"
#include "tests/support/scratch_folder.hpp"

namespace eti::hdf5 {
namespace {

class Hdf5 : public test::ScratchFolderTest {
  protected:
    const std::filesystem::path path = folder / "file.h5";
};

std::string refusal(const std::function<void()>& action) {
    return test::error_of<Error>(action);
}

TEST_F(Hdf5, NumbersTextsAndAttributesRoundTrip) {
    std::vector<double> large(300000);
    std::iota(large.begin(), large.end(), 0.5);
    const std::vector<std::string> texts{"trachea", "", "µ"};
    {
        File file = File::create(path);
        const Group group = file.root().create("group");
        group.write<double>("large", large, {100, 3000}, {"m", "more than one chunk"});
        group.write<float>("empty", {}, {0, 3}, {"m", "no rows"});
        group.write_texts("texts", texts, {"1", "names"});
        group.write_texts("no_texts", {}, {"1", "names"});
        group.set_text("text", "line\nline µ");
        group.set_number("number", 0.1);
        group.set_integer("integer", ~std::uint64_t{0});
        file.close();
    }
    const File file = File::open(path, Access::read);
    const Group group = file.root().open("group");
    EXPECT_EQ(group.read<double>("large", {any_extent, 3000}).values, large);
    EXPECT_EQ(group.read<float>("empty", {any_extent, 3}).shape, (Shape{0, 3}));
    EXPECT_EQ(group.read_texts("texts"), texts);
    EXPECT_TRUE(group.read_texts("no_texts").empty());
    EXPECT_EQ(group.text("text"), "line\nline µ");
    EXPECT_EQ(group.number("number"), 0.1);
    EXPECT_EQ(group.integer("integer"), ~std::uint64_t{0});
    EXPECT_EQ(file.root().members(), std::vector<std::string>{"group"});
    EXPECT_TRUE(file.root().is_group("group"));
    EXPECT_FALSE(group.is_group("large"));
}

TEST_F(Hdf5, ErrorsNameFilePlaceAndFinding) {
    {
        File file = File::create(path);
        const Group group = file.root().create("group");
        group.write<float>("values", std::vector<float>{1, 2, 3}, {3}, {"m", "three"});
        group.set_text("text", "text");
        file.close();
    }
    const File file = File::open(path, Access::read);
    const Group group = file.root().open("group");
    const auto expect = [&](const std::function<void()>& action, const std::vector<std::string>& words) {
        const std::string text = refusal(action);
        for (const std::string& word : words) {
            EXPECT_NE(text.find(word), std::string::npos) << word << " is not in: " << text;
        }
    };
    const std::string place = path.string() + ": /group";
    expect([&] { (void)group.read<float>("absent", {3}); }, {place + "/absent", "missing"});
    expect([&] { (void)group.read<float>("values", {4}); }, {place + "/values", "(3)", "(4)"});
    expect([&] { (void)group.read<float>("values", {3, 1}); }, {place + "/values", "(3)", "(3 x 1)"});
    expect([&] { (void)group.read<double>("values", {3}); }, {place + "/values", "8-byte floating-point"});
    expect([&] { (void)group.read<std::uint32_t>("values", {3}); }, {place + "/values", "4-byte integer"});
    expect([&] { (void)group.read_texts("values"); }, {place + "/values", "texts"});
    expect([&] { (void)file.root().open("absent"); }, {path.string() + ": /absent", "missing"});
    expect([&] { (void)group.text("absent"); }, {place, "absent", "missing"});
    expect([&] { (void)group.number("text"); }, {place, "text", "type"});
    expect([&] { (void)File::create(path); }, {path.string(), "already exists"});
    expect([&] { (void)File::open(folder, Access::read); }, {folder.string(), "not a regular file"});
}

TEST_F(Hdf5, ExcessiveSizeIsRefusedBeforeAllocation) {
    {
        File file = File::create(path);
        // 2^40 rows, none of them written: the file stays small.
        const hsize_t extent[] = {hsize_t{1} << 40}, chunk[] = {1024};
        const Handle space(H5Screate_simple(1, extent, nullptr), H5Sclose);
        const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
        H5Pset_chunk(creation.get(), 1, chunk);
        const Handle set(H5Dcreate2(file.id(), "huge", H5T_NATIVE_FLOAT, space.get(), H5P_DEFAULT,
                                    creation.get(), H5P_DEFAULT),
                         H5Dclose);
        ASSERT_TRUE(set);
    }
    const File file = File::open(path, Access::read);
    EXPECT_NE(refusal([&] { (void)file.root().read<float>("huge", {any_extent}); }).find("damaged"),
              std::string::npos);
}

TEST_F(Hdf5, MeshesAndSkinsAreCheckedWhenRead) {
    TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
    const auto reread = [&] {
        std::filesystem::remove(path);
        File file = File::create(path);
        write_mesh(file.root(), mesh);
        return refusal([&] { (void)read_mesh(file.root()); });
    };
    EXPECT_EQ(reread(), "");
    mesh.triangles[0][1] = 3;
    EXPECT_NE(reread().find("/triangles: value 1 is 3, but there are only 3 vertices"), std::string::npos);
    mesh.triangles[0][1] = 1;
    mesh.vertices[2].z() = std::numeric_limits<float>::infinity();
    EXPECT_NE(reread().find("/vertices: value 8 is not finite"), std::string::npos);
}

TEST_F(Hdf5, SystemCallErrorIsReportedVerbatim) {
    {
        File file = File::create(path);
        file.close();
    }
    // A path that cannot be written: the kernel does not open a running program for writing.
    const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
    const Handle properties(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    EXPECT_LT(H5Fopen(program.c_str(), H5F_ACC_RDWR, properties.get()), 0);
    EXPECT_EQ(last_error(), "Text file busy");
}

}  // namespace
}  // namespace eti::hdf5
