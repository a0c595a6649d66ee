// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/annotator.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "client/app/window/special_keys.hpp"

namespace eti::client {
namespace {

render::PickHit on(const std::string& object, std::uint32_t triangle) {
    return {Vec3f::Zero(), "tongue", object, {triangle, 0.1f, 0.2f, 0.0f}};
}

class AnnotatorTest : public ::testing::Test {
  protected:
    void type(std::u32string_view text) {
        for (const char32_t c : text) {
            annotator_.press(c);
        }
    }
    [[nodiscard]] std::vector<std::uint32_t> triangles(std::size_t i) const {
        std::vector<std::uint32_t> out;
        for (const msg::SurfacePlace& place : sent_.at(i).places()) {
            out.push_back(place.triangle());
        }
        return out;
    }

    bool served_ = true;
    std::vector<msg::Annotation> sent_;
    Annotator annotator_{"desk:7", [this](const msg::Annotation& annotation) {
                             sent_.push_back(annotation);
                             return served_;
                         }};
};

TEST_F(AnnotatorTest, ClickSendsPoint) {
    annotator_.begin(on("tongue", 5));
    EXPECT_TRUE(annotator_.sketch());
    annotator_.end();
    ASSERT_EQ(sent_.size(), 1u);
    EXPECT_EQ(sent_[0].kind(), msg::ANNOTATION_POINT);
    EXPECT_EQ(sent_[0].sender().to_string(), "desk:7");
    EXPECT_EQ(sent_[0].object().to_string(), "tongue");
    EXPECT_EQ(triangles(0), std::vector<std::uint32_t>{5});
    EXPECT_FALSE(annotator_.sketch());
    annotator_.end();
    EXPECT_EQ(sent_.size(), 1u);
}

TEST_F(AnnotatorTest, DragSendsOneStrokePerObject) {
    annotator_.begin(on("tongue", 1));
    annotator_.extend(on("tongue", 2));
    annotator_.extend(std::nullopt);  // into the air
    annotator_.extend(on("body", 7));
    annotator_.extend(on("body", 8));
    annotator_.end();
    ASSERT_EQ(sent_.size(), 2u);
    EXPECT_EQ(sent_[0].kind(), msg::ANNOTATION_STROKE);
    EXPECT_EQ(triangles(0), (std::vector<std::uint32_t>{1, 2}));
    EXPECT_EQ(sent_[1].object().to_string(), "body");
    EXPECT_EQ(triangles(1), (std::vector<std::uint32_t>{7, 8}));
}

TEST_F(AnnotatorTest, LongStrokeIsSplitIntoConnectedMessages) {
    annotator_.begin(on("tongue", 0));
    for (std::uint32_t i = 1; i < 100; ++i) {
        annotator_.extend(on("tongue", i));
    }
    annotator_.end();
    ASSERT_EQ(sent_.size(), 3u);
    EXPECT_EQ(triangles(0).size(), msg::bound::Annotation_places);
    EXPECT_EQ(triangles(1).front(), triangles(0).back());
    EXPECT_EQ(triangles(2).front(), triangles(1).back());
    EXPECT_EQ(triangles(2).back(), 99u);
}

TEST_F(AnnotatorTest, ExplainsRejectedMarks) {
    annotator_.begin(render::PickHit{Vec3f::Zero(), "tube"});
    EXPECT_EQ(annotator_.take_error(), "the tube cannot be marked: point at tissue or at the blade");
    annotator_.begin(std::nullopt);
    EXPECT_EQ(annotator_.take_error(), "nothing to mark there");
    annotator_.end();
    EXPECT_TRUE(sent_.empty());
    served_ = false;
    annotator_.wipe();
    EXPECT_EQ(annotator_.take_error(), "no server accepts remarks or marks");
    EXPECT_EQ(annotator_.take_error(), "");
}

TEST_F(AnnotatorTest, EnterSendsTextAndEscapeDiscardsIt) {
    type(U"lost");
    annotator_.write();
    ASSERT_TRUE(annotator_.writing());
    type(U"Zung\u00e4");
    annotator_.press(key_backspace);
    type(U"e");
    annotator_.press(key_up);
    EXPECT_EQ(annotator_.words(), "Zunge");
    annotator_.press(key_enter);
    EXPECT_FALSE(annotator_.writing());
    ASSERT_EQ(sent_.size(), 1u);
    EXPECT_EQ(sent_[0].kind(), msg::ANNOTATION_NOTE);
    EXPECT_EQ(sent_[0].text().to_string(), "Zunge");
    annotator_.write();
    type(U"no");
    annotator_.press(key_escape);
    annotator_.write();
    annotator_.press(key_enter);
    EXPECT_EQ(sent_.size(), 1u);
    // As many bytes as a message holds, without splitting a character.
    annotator_.write();
    type(std::u32string(150, U'\u00e9'));
    EXPECT_EQ(annotator_.words().size(), msg::bound::Annotation_text);
}

TEST_F(AnnotatorTest, TypedTextIsSentWithPoint) {
    annotator_.write();
    type(U"lift here");
    annotator_.begin(on("tongue", 5));
    annotator_.end();
    ASSERT_EQ(sent_.size(), 1u);
    EXPECT_EQ(sent_[0].kind(), msg::ANNOTATION_POINT);
    EXPECT_EQ(sent_[0].text().to_string(), "lift here");
    EXPECT_FALSE(annotator_.writing());
}

}  // namespace
}  // namespace eti::client
