// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/scenario/data_file.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "common/process/files/file_kind.hpp"

namespace eti {

namespace {

constexpr std::uintmax_t largest_file = 1024 * 1024;

std::vector<std::filesystem::path> data_folders(const std::string& kind) {
    std::vector<std::filesystem::path> folders;
    if (const char* own = std::getenv("ETI_DATA"); own != nullptr && *own != '\0') {
        folders.push_back(std::filesystem::path(own) / kind);
    }
    std::error_code error;
    const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
    if (!error) {
        folders.push_back(program.parent_path().parent_path() / "share" / "neoeti" / kind);
    }
    return folders;
}

}  // namespace

std::vector<std::string> data_names(const std::string& kind) {
    std::vector<std::string> names;
    std::error_code error;
    for (const std::filesystem::path& folder : data_folders(kind)) {
        for (std::filesystem::directory_iterator i(folder, error), end; !error && i != end;
             i.increment(error)) {
            if (i->path().extension() == ".yaml") {
                names.push_back(i->path().stem().string());
            }
        }
    }
    std::sort(names.begin(), names.end());
    names.erase(std::unique(names.begin(), names.end()), names.end());
    return names;
}

std::filesystem::path find_data_file(const std::string& name_or_path, const std::string& kind) {
    const std::filesystem::path given(name_or_path);
    std::error_code error;
    if (std::filesystem::is_regular_file(given, error)) {
        return given;
    }
    std::vector<std::string> searched;
    // A name, not a path: it cannot leave the data folders.
    const bool is_name = !name_or_path.empty() && given.filename() == given && given != ".." && given != ".";
    for (const std::filesystem::path& folder : data_folders(kind)) {
        searched.push_back(folder.string());
        if (is_name && std::filesystem::is_regular_file(folder / (name_or_path + ".yaml"), error)) {
            return folder / (name_or_path + ".yaml");
        }
    }
    const std::vector<std::string> names = data_names(kind);
    throw InputError(fmt::format("'{}' is neither a file nor a name in {}; available names: {}", name_or_path,
                                 fmt::join(searched, ", "),
                                 names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
}

std::string read_text_file(const std::filesystem::path& file) {
    if (const std::string kind = describe_non_regular(file); !kind.empty()) {
        throw InputError(fmt::format("{}: found {}, expected a file; check the path", file.string(), kind));
    }
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    if (error || size > largest_file) {
        throw InputError(fmt::format("{}: {} bytes, expected at most {}; is this the right file?",
                                     file.string(), size, largest_file));
    }
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    if (!in) {
        throw InputError(fmt::format("{}: could not be read; check its permissions", file.string()));
    }
    return text.str();
}

}  // namespace eti
