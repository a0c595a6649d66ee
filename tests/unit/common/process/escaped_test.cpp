// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/escaped.hpp"

#include <gtest/gtest.h>

namespace eti {
namespace {

TEST(Escaped, PlainUnicodeTextIsUnchanged) {
    for (const char* const text : {"", "expert", "Säugling 3.5 kg", "乳児", "👶", "a\\b"}) {
        EXPECT_EQ(escaped(text), text);
        EXPECT_EQ(escaped_lines(text), text);
    }
}

TEST(Escaped, ControlSequencesAreEscaped) {
    EXPECT_EQ(escaped("\x1b]0;title\x07"), "\\x1b]0;title\\x07");
    EXPECT_EQ(escaped("a\rb\x7f"), "a\\x0db\\x7f");
    EXPECT_EQ(escaped(std::string_view("a\0b", 3)), "a\\x00b");
    EXPECT_EQ(escaped("\xc2\x9b"
                      "31m"),
              "\\xc2\\x9b31m");  // U+009B starts a control sequence, too
    EXPECT_EQ(escaped("two\nlines\t"), "two\\nlines\\t");
    EXPECT_EQ(escaped_lines("two\nlines\t\x1b"), "two\nlines\t\\x1b");
}

TEST(Escaped, InvalidUtf8BytesAreEscaped) {
    EXPECT_EQ(escaped("\xff"), "\\xff");
    EXPECT_EQ(escaped("a\xc3"), "a\\xc3");           // truncated
    EXPECT_EQ(escaped("\x80\xbf"), "\\x80\\xbf");    // continuation bytes only
    EXPECT_EQ(escaped("\xc0\x80"), "\\xc0\\x80");    // overlong encoding
    EXPECT_EQ(escaped("\xe4\xb9z"), "\\xe4\\xb9z");  // the next character comes too early
}

TEST(Escaped, LongTextIsCutAtAWholeCharacter) {
    EXPECT_EQ(escaped("abcdef", 3), "abc...");
    EXPECT_EQ(escaped("abc", 3), "abc");
    EXPECT_EQ(escaped("abä", 3), "ab...");
    EXPECT_EQ(escaped("ab\x1b", 5), "ab...");
}

}  // namespace
}  // namespace eti
