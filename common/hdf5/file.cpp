// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/hdf5/file.hpp"

#include <fmt/format.h>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "common/process/files/file_kind.hpp"

namespace eti::hdf5 {

namespace {

Handle access_properties() {
    Handle properties(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    H5Pset_libver_bounds(properties.get(), H5F_LIBVER_V110, H5F_LIBVER_V110);
    // Closing the handle closes the file, even if other objects in it are still open.
    H5Pset_fclose_degree(properties.get(), H5F_CLOSE_STRONG);
    // Some network file systems do not support locks; recording without one is better than refusing.
    H5Pset_file_locking(properties.get(), true, true);
    // Data is in the file when the call returns, so killing the process does not lose it.
    H5Pset_sieve_buf_size(properties.get(), 0);
    return properties;
}

/// The unit in which a Unix kernel copies data into a file [bytes]. A signal that kills the writer can end a
/// write between two such units.
constexpr hsize_t memory_page = 4096;

/// Metadata blocks smaller than a page never cross a page boundary. A killed writer therefore leaves each
/// block either old or new, never with a checksum that does not match.
Handle creation_properties() {
    Handle properties(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    H5Pset_file_space_strategy(properties.get(), H5F_FSPACE_STRATEGY_PAGE, false, 1);
    H5Pset_file_space_page_size(properties.get(), memory_page);
    H5Pset_obj_track_times(properties.get(), false);  // of the root group; creation times are unused
    return properties;
}

unsigned flags_of(Access access) {
    switch (access) {
        case Access::read:
            return H5F_ACC_RDONLY;
        case Access::read_swmr:
        case Access::read_orphaned:
            return H5F_ACC_RDONLY | H5F_ACC_SWMR_READ;
        case Access::modify:
            return H5F_ACC_RDWR;
        case Access::append_swmr:
            return H5F_ACC_RDWR | H5F_ACC_SWMR_WRITE;
    }
    return H5F_ACC_RDONLY;
}

}  // namespace

void require_regular_file(const std::filesystem::path& path) {
    std::error_code error;
    const std::string kind = describe_non_regular(path);
    if (kind == "nothing") {
        throw Error(fmt::format("{}: no such file; check the path", path.string()));
    }
    if (!kind.empty()) {
        throw Error(fmt::format("{}: not a regular file but {}; name a file", path.string(), kind));
    }
    if (std::filesystem::file_size(path, error) == 0) {
        throw Error(fmt::format("{}: the file is empty", path.string()));
    }
    errno = 0;
    if (!std::ifstream(path)) {
        throw Error(fmt::format("{}: cannot be opened: {}", path.string(), std::strerror(errno)));
    }
}

File::File(Handle id, const std::filesystem::path& path) : id_(std::move(id)), path_(path) {
    Handle root(H5Gopen2(id_.get(), "/", H5P_DEFAULT), H5Gclose);
    if (!root) {
        throw Error(fmt::format("{}: no readable root group: {}", path.string(), last_error()));
    }
    root_ = Group(std::move(root), path.string() + ": /");
}

File File::create(const std::filesystem::path& path) {
    prepare_thread();
    const Handle creation = creation_properties(), access = access_properties();
    std::error_code error;
    if (std::filesystem::exists(path, error)) {
        throw Error(fmt::format("{}: already exists and is not overwritten; choose another name or remove it",
                                path.string()));
    }
    errno = 0;
    Handle id(H5Fcreate(path.c_str(), H5F_ACC_EXCL, creation.get(), access.get()), H5Fclose);
    if (!id) {
        const int reason = errno;
        throw Error(fmt::format("{}: cannot be created: {}; name an existing, writable folder", path.string(),
                                reason != 0 ? std::strerror(reason) : last_error()));
    }
    return {std::move(id), path};
}

File File::open(const std::filesystem::path& path, Access access, const std::filesystem::path& display_name) {
    prepare_thread();
    require_regular_file(path);
    if (H5Fis_hdf5(path.c_str()) <= 0) {
        throw Error(fmt::format("{}: not an HDF5 file", path.string()));
    }
    const Handle properties = access_properties();
    if (access == Access::read_orphaned || access == Access::append_swmr) {
        // By default the library retries every damaged block for up to a second, with many blocks for hours,
        // although no other writer will complete it.
        H5Pset_metadata_read_attempts(properties.get(), 1);
    }
    Handle id(H5Fopen(path.c_str(), flags_of(access), properties.get()), H5Fclose);
    if (!id) {
        throw Error(fmt::format("{}: cannot be opened: {}", path.string(), last_error()));
    }
    return {std::move(id), display_name.empty() ? path : display_name};
}

void File::close() {
    root_ = Group();
    if (!id_.close()) {
        throw Error(fmt::format("{}: writing did not complete: {}", path_.string(), last_error()));
    }
}

void File::abandon() {
    id_.abandon();
}

}  // namespace eti::hdf5
