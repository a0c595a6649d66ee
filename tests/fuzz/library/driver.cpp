// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// In place of libFuzzer, where the compiler has none: reads the inputs named, as replay.cpp does, and with
// -runs=N also N mutants of them, by the same mutations but blind. At the library's full speed, and on the
// very library that is installed.
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string_view>
#include <vector>

#include "tests/fuzz/reader.hpp"

extern "C" {
std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                    unsigned seed);
std::size_t LLVMFuzzerCustomCrossOver(const std::uint8_t* one, std::size_t one_size,
                                      const std::uint8_t* other, std::size_t other_size, std::uint8_t* out,
                                      std::size_t max_size, unsigned seed);
std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);
}

namespace {

using Input = std::vector<std::uint8_t>;

std::minstd_rand random_number;

std::size_t below(std::size_t end) {
    return end == 0 ? 0 : random_number() % end;
}

std::uint64_t number(std::string_view argument, std::string_view option, std::uint64_t unset) {
    if (argument.starts_with(option)) {
        argument.remove_prefix(option.size());
        std::from_chars(argument.data(), argument.data() + argument.size(), unset);
    }
    return unset;
}

}  // namespace

/// A byte is changed, inserted or removed.
std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size) {
    const std::size_t at = below(size);
    std::uint8_t* const end = data + size;
    switch (below(4)) {
        case 0:
            if (size < max_size) {
                std::copy_backward(data + at, end, end + 1);
                data[at] = static_cast<std::uint8_t>(random_number());
                return size + 1;
            }
            break;
        case 1:
            if (size > 1) {
                std::copy(data + at + 1, end, data + at);
                return size - 1;
            }
            break;
        default:
            break;
    }
    if (size > 0) {
        data[at] = static_cast<std::uint8_t>(below(2) == 0 ? random_number() : data[at] ^ 1u << below(8));
    }
    return size;
}

int main(int argc, char** argv) {
    constexpr std::size_t max_bytes = 40000;
    std::uint64_t runs = 0, seed = 1;
    std::vector<std::filesystem::path> files;
    for (int i = 1; i < argc; ++i) {
        const std::string_view argument = argv[i];
        runs = number(argument, "-runs=", runs);
        seed = number(argument, "-seed=", seed);
        if (argument.starts_with('-')) {
            continue;
        }
        if (std::filesystem::is_directory(argument)) {
            for (const auto& entry : std::filesystem::directory_iterator(argument)) {
                files.push_back(entry.path());
            }
        } else {
            files.emplace_back(argument);
        }
    }
    std::ranges::sort(files);
    std::vector<Input> inputs;
    for (const std::filesystem::path& file : files) {
        std::ifstream in(file, std::ios::binary);
        inputs.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
        (void)std::fprintf(stderr, "%s\n", file.c_str());
        LLVMFuzzerTestOneInput(inputs.back().data(), inputs.back().size());
    }
    std::printf("%zu inputs read\n", files.size());
    random_number.seed(static_cast<unsigned>(seed));
    Input mutant(max_bytes);
    for (std::uint64_t i = 0; i < runs && !inputs.empty(); ++i) {
        const Input& one = inputs[below(inputs.size())];
        std::size_t size = std::min(one.size(), max_bytes);
        std::copy_n(one.begin(), size, mutant.begin());
        if (below(4) == 0) {
            const Input& other = inputs[below(inputs.size())];
            size =
                LLVMFuzzerCustomCrossOver(one.data(), one.size(), other.data(), other.size(), mutant.data(),
                                          max_bytes, static_cast<unsigned>(random_number()));
        }
        size =
            LLVMFuzzerCustomMutator(mutant.data(), size, max_bytes, static_cast<unsigned>(random_number()));
        LLVMFuzzerTestOneInput(mutant.data(), size);
    }
    return files.empty() ? 1 : 0;
}
