// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "common/hdf5/handle.hpp"
#include "memory_file.hpp"
#include "reader.hpp"

namespace eti::fuzz {

// Bytes as a list of edits to an HDF5 file. The library itself is known to crash on damaged files, and reads
// untrusted ones in a separate process. The target is our reader: a file that is valid for the library, with
// numbers, types, extents and names other than ours.

/// Reads numbers from a span of bytes; zeros after its end.
class Bytes {
  public:
    Bytes(const std::uint8_t* data, std::size_t size) : bytes_(data, size) {}
    [[nodiscard]] bool empty() const { return bytes_.empty(); }
    std::uint8_t byte() {
        if (bytes_.empty()) {
            return 0;
        }
        const std::uint8_t first = bytes_.front();
        bytes_ = bytes_.subspan(1);
        return first;
    }
    std::size_t below(std::size_t count) {
        const std::size_t high = byte();
        return count == 0 ? 0 : (256 * high + byte()) % count;
    }
    void fill(void* to, std::size_t size) {
        for (std::size_t i = 0; i < size; ++i) {
            static_cast<std::uint8_t*>(to)[i] = byte();
        }
    }

  private:
    std::span<const std::uint8_t> bytes_;
};

/// The edits that `bytes` encode, in order, to objects of `file` by their index among all objects.
class Hdf5Edits {
  public:
    Hdf5Edits(hid_t file, Bytes bytes) : file_(file), bytes_(bytes) {
        H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, &Hdf5Edits::take, &names_, H5O_INFO_BASIC);
    }

    void make() {
        for (int edits = 0; edits < 8 && !bytes_.empty() && !names_.empty(); ++edits) {
            const std::uint8_t kind = bytes_.byte();
            const std::string& name = names_[bytes_.below(names_.size())];
            switch (kind % 6) {
                case 0:
                    H5Ldelete(file_, name.c_str(), H5P_DEFAULT);
                    break;
                case 2:
                    extents(name);
                    break;
                case 3:
                    replace(name);
                    break;
                case 4:
                    attribute(name);
                    break;
                case 5:
                    alias(name);
                    break;
                default:
                    numbers(name);
                    break;
            }
        }
    }

  private:
    static herr_t take(hid_t, const char* name, const H5O_info_t*, void* names) {
        if (std::strcmp(name, ".") != 0) {
            static_cast<std::vector<std::string>*>(names)->emplace_back(name);
        }
        return 0;
    }

    [[nodiscard]] hid_t data_set(const std::string& name) const {
        const hid_t object = H5Oopen(file_, name.c_str(), H5P_DEFAULT);
        if (object >= 0 && H5Iget_type(object) != H5I_DATASET) {
            H5Oclose(object);
            return -1;
        }
        return object;
    }

    /// Overwrites some elements with other bytes.
    void numbers(const std::string& name) {
        const hdf5::Handle set(data_set(name), &H5Oclose);
        if (!set) {
            return;
        }
        const hdf5::Handle type(H5Dget_type(set.get()), &H5Tclose);
        const hdf5::Handle space(H5Dget_space(set.get()), &H5Sclose);
        const std::size_t size = H5Tget_size(type.get());
        const hssize_t count = H5Sget_simple_extent_npoints(space.get());
        // Variable-length strings are pointers in memory.
        if (H5Tdetect_class(type.get(), H5T_VLEN) > 0 || H5Tis_variable_str(type.get()) > 0 || count <= 0 ||
            count > 1 << 16) {
            return;
        }
        std::vector<std::uint8_t> values(size * static_cast<std::size_t>(count));
        H5Dread(set.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
        const std::size_t from = bytes_.below(static_cast<std::size_t>(count));
        const std::size_t many =
            std::min<std::size_t>(1 + bytes_.byte() % 4, static_cast<std::size_t>(count) - from);
        bytes_.fill(values.data() + from * size, many * size);
        H5Dwrite(set.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    }

    /// More or fewer rows.
    void extents(const std::string& name) {
        const hdf5::Handle set(data_set(name), &H5Oclose);
        if (!set) {
            return;
        }
        const hdf5::Handle space(H5Dget_space(set.get()), &H5Sclose);
        std::array<hsize_t, H5S_MAX_RANK> now{};
        if (H5Sget_simple_extent_dims(space.get(), now.data(), nullptr) > 0) {
            now[0] = bytes_.below(2000);
            H5Dset_extent(set.get(), now.data());
        }
    }

    /// Replaces it by another data set, or a group.
    void replace(const std::string& name) {
        H5Ldelete(file_, name.c_str(), H5P_DEFAULT);
        const hdf5::Handle links(H5Pcreate(H5P_LINK_CREATE), &H5Pclose);
        H5Pset_create_intermediate_group(links.get(), 1);
        const std::array types = {H5T_IEEE_F32LE, H5T_IEEE_F64LE, H5T_STD_U8LE,  H5T_STD_U16LE,
                                  H5T_STD_U32LE,  H5T_STD_U64LE,  H5T_STD_I64LE, H5T_C_S1};
        const std::size_t kind = bytes_.byte() % (types.size() + 1);
        if (kind == types.size()) {
            H5Gclose(H5Gcreate2(file_, name.c_str(), links.get(), H5P_DEFAULT, H5P_DEFAULT));
            return;
        }
        const int rank = bytes_.byte() % 4;
        std::array<hsize_t, 4> shape{};
        for (int i = 0; i < rank; ++i) {
            shape[static_cast<std::size_t>(i)] = bytes_.below(i == 0 ? 400 : 12);
        }
        const hdf5::Handle space(rank == 0 ? H5Screate(bytes_.byte() % 2 ? H5S_SCALAR : H5S_NULL)
                                           : H5Screate_simple(rank, shape.data(), nullptr),
                                 &H5Sclose);
        const hdf5::Handle set(H5Dcreate2(file_, name.c_str(), types.at(kind), space.get(), links.get(),
                                          H5P_DEFAULT, H5P_DEFAULT),
                               &H5Dclose);
    }

    /// Clears, replaces or removes one of its attributes.
    void attribute(const std::string& name) {
        // The root group's attributes identify the file.
        const char* const place = bytes_.byte() % 2 ? "." : name.c_str();
        const hdf5::Handle object(H5Oopen(file_, place, H5P_DEFAULT), &H5Oclose);
        H5O_info_t info{};
        if (!object || H5Oget_info2(object.get(), &info, H5O_INFO_NUM_ATTRS) < 0 || info.num_attrs == 0) {
            return;
        }
        const std::size_t which = bytes_.below(info.num_attrs);
        if (bytes_.byte() % 4 == 0) {
            H5Adelete_by_idx(object.get(), ".", H5_INDEX_NAME, H5_ITER_INC, which, H5P_DEFAULT);
            return;
        }
        const hdf5::Handle found(
            H5Aopen_by_idx(object.get(), ".", H5_INDEX_NAME, H5_ITER_INC, which, H5P_DEFAULT, H5P_DEFAULT),
            &H5Aclose);
        const hdf5::Handle type(H5Aget_type(found.get()), &H5Tclose);
        if (H5Tis_variable_str(type.get()) > 0) {
            return;
        }
        const hdf5::Handle space(H5Aget_space(found.get()), &H5Sclose);
        const hssize_t count = H5Sget_simple_extent_npoints(space.get());
        if (count <= 0) {
            return;
        }
        std::vector<std::uint8_t> value(H5Tget_size(type.get()) * static_cast<std::size_t>(count));
        H5Aread(found.get(), type.get(), value.data());
        bytes_.fill(value.data() + bytes_.below(value.size()), 1);
        H5Awrite(found.get(), type.get(), value.data());
    }

    /// Links one object under the name of another.
    void alias(const std::string& name) {
        const std::string& other = names_[bytes_.below(names_.size())];
        if (name != other) {
            H5Ldelete(file_, name.c_str(), H5P_DEFAULT);
            H5Lcreate_hard(file_, other.c_str(), file_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
        }
    }

    hid_t file_;
    Bytes bytes_;
    std::vector<std::string> names_;
};

/// Writes a valid file into `file`, with the edits that `data` encodes.
inline void hold_changed(const MemoryFile& file, const std::vector<char>& sound, const std::uint8_t* data,
                         std::size_t size) {
    file.hold(sound.data(), sound.size());
    const hdf5::Handle opened(H5Fopen(file.path().c_str(), H5F_ACC_RDWR, H5P_DEFAULT), &H5Fclose);
    require(static_cast<bool>(opened), "the sound file cannot be opened");
    Hdf5Edits(opened.get(), Bytes(data, size)).make();
}

}  // namespace eti::fuzz
