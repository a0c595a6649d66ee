// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "coarse_phantom.hpp"
#include "server/patient/imaging/read.hpp"
#include "server/patient/segmentation/segment.hpp"
#include "server/patient/segmentation/surfaces.hpp"

namespace eti::segmentation {
namespace {

/// A real CT: an adult's head down to the hard palate, from Debian's package invesalius-examples.
const std::filesystem::path cranium = "/usr/share/doc/invesalius-examples/examples/Cranium.inv3";

TEST(Cranium, ScanYieldsOnlyVisibleStructures) {
    if (!std::filesystem::exists(cranium)) {
        GTEST_SKIP() << cranium << " is not installed (package invesalius-examples)";
    }
    const imaging::Volume ct = imaging::read(cranium).volume;
    ASSERT_EQ(ct.geometry.size, (std::array<int, 3>{256, 256, 108}));
    const Segmentation found = segment(ct, {}, {}, test::silent);
    for (const Structure& s : found.structures) {
        const bool shown = s.name == "skin" || s.name == "bone" || s.name == "airway";
        EXPECT_EQ(s.found, shown) << s.name << ": " << s.note;
        EXPECT_EQ(s.note.empty(), shown) << s.name << ": " << s.note;
    }
    for (const Label label : {Label::mandible, Label::tongue, Label::epiglottis}) {
        EXPECT_EQ(std::count(found.labels.value.begin(), found.labels.value.end(), value_of(label)), 0);
    }
    const auto surfaces = make_surfaces(found.labels, &ct, {}, test::silent);
    ASSERT_EQ(surfaces.size(), 3u);
    for (const NamedSurface& surface : surfaces) {
        EXPECT_TRUE(surface.report.is_valid()) << surface.name << ": " << surface.report.describe();
    }
}

}  // namespace
}  // namespace eti::segmentation
