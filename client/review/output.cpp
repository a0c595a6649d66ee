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
        throw ExportError(fmt::format("{}: exists already and is not overwritten; choose another with {}",
                                      path.string(), option));
    }
}

void write_new_file(const std::filesystem::path& path, std::string_view text, std::string_view option) {
    refuse_existing(path, option);
    write_file(path, text, option);
}

void write_file(const std::filesystem::path& path, std::string_view text, std::string_view option) {
    std::error_code ignored;
    const bool is_new = path.has_parent_path() && !std::filesystem::exists(path.parent_path(), ignored);
    if (path.has_parent_path()) {
        make_folder(path.parent_path(), option);
    }
    if (const std::string why = write_file_atomically(path, text); !why.empty()) {
        if (is_new) {
            std::filesystem::remove(path.parent_path(), ignored);  // only if it is empty
        }
        throw ExportError(fmt::format("{}: cannot write: {}; free some space or choose another with {}",
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

std::string html_page(std::string_view title, std::string_view body) {
    constexpr std::string_view before = R"(<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'">
<title>)";
    constexpr std::string_view after = R"(</title>
<style>
body { margin: 0 auto; max-width: 1180px; padding: 16px; color: #1d2329; font: 15px/1.45 system-ui, "DejaVu Sans", sans-serif; }
h1 { font-size: 1.6rem; margin: 0 0 4px; } h2 { font-size: 1.15rem; margin: 20px 0 6px; }
.wide { overflow-x: auto; } table { border-collapse: collapse; width: 100%; }
th, td { padding: 3px 8px; text-align: right; border-bottom: 1px solid #d5dae0; white-space: nowrap; font-variant-numeric: tabular-nums; }
th:first-child, td:first-child, th:nth-child(2), td:nth-child(2) { text-align: left; white-space: normal; }
tr.part th { background: #f4f6f8; text-align: left; } .soft { color: #55606b; font-size: 0.88rem; }
tr.distinct td { font-weight: 600; }
pre { white-space: pre-wrap; }
</style>
</head>
<body>
)";
    return fmt::format("{}{}{}{}</body>\n</html>\n", before, html_text(title), after, body);
}

std::string csv_text(std::string_view text) {
    std::string out = "\"";
    // A spreadsheet would run a text that begins so as a formula.
    if (!text.empty() && std::string_view("=+-@\t\r").find(text.front()) != std::string_view::npos) {
        out += '\'';
    }
    for (const char c : text) {
        out.append(c == '"' ? 2 : 1, c);
    }
    return out + '"';
}

nlohmann::ordered_json number_or_null(double value) {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

}  // namespace eti::review
