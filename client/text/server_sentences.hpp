// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace eti::text {

/// Sentences with numbers that a server writes; `{}` stands for a number or another sentence.
[[nodiscard]] std::span<const std::string_view> server_sentences();

/// A server's sentence in the selected language. Servers and session files speak English; what matches no
/// known sentence stays as it is.
[[nodiscard]] std::string translate_sentence(std::string_view english);

}  // namespace eti::text
