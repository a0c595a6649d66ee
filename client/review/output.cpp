// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/review/output.hpp"

#include <fmt/format.h>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/process/files/atomic_file_writer.hpp"
#include "common/process/files/folder.hpp"

namespace eti::review {

void refuse_existing(const std::filesystem::path& path, std::string_view option) {
    std::error_code ignored;
    if (std::filesystem::exists(path, ignored)) {
        throw ExportError(fmt::format("{}: exists already and is not replaced; choose another with {}",
                                      path.string(), option));
    }
}

void write_new_file(const std::filesystem::path& path, std::string_view text, std::string_view option) {
    refuse_existing(path, option);
    write_file(path, text, option);
}

void write_file(const std::filesystem::path& path, std::string_view text, std::string_view option) {
    if (path.has_parent_path()) {
        make_folder(path.parent_path(), option);
    }
    if (const std::string why = write_file_atomically(path, text); !why.empty()) {
        throw ExportError(fmt::format("{}: cannot be written: {}; make room or choose another with {}",
                                      path.string(), why, option));
    }
}

std::string html_text(std::string_view text) {
    std::string out;
    for (const char c : text) {
        switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            default:
                out += c;
        }
    }
    return out;
}

std::string csv_text(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
        out.append(c == '"' ? 2 : 1, c);
    }
    return out + '"';
}

nlohmann::ordered_json number_or_null(double value) {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

}  // namespace eti::review
