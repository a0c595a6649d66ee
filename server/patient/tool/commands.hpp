// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <functional>
#include <memory>

#include "common/model/newborn_shape.hpp"
#include "common/process/command_line.hpp"
#include "server/patient/imaging/read.hpp"
#include "server/patient/segmentation/surfaces.hpp"
#include "server/patient/tool/terminal.hpp"

namespace eti::tool {

/// What the command line asked for; set while it is parsed.
using Run = std::function<Result()>;

void add_build(CommandLine& app, Run& run);
void add_check(CommandLine& app, Run& run);

/// Options for every parameter of the newborn's shape.
class ShapeOptions {
  public:
    explicit ShapeOptions(CommandLine& command);
    /// The shape that was asked for. Throws std::runtime_error where there is no such newborn.
    [[nodiscard]] NewbornShape shape() const;
    /// Whether any of the options was given.
    [[nodiscard]] bool any() const;

  private:
    struct Typed;
    std::shared_ptr<Typed> typed_;
};

/// Reads a volume and passes on what is remarkable about it. Throws imaging::VolumeError, Stopped.
[[nodiscard]] imaging::Reading read_told(const std::filesystem::path& file);
/// Reads labels as eti-anatomy numbers them.
[[nodiscard]] imaging::Mask read_labels(const std::filesystem::path& file);

/// Writes each surface as STL into a folder, which is made, and says so.
[[nodiscard]] Result write_surfaces(const std::vector<NamedSurface>& surfaces,
                                    const std::filesystem::path& folder);

}  // namespace eti::tool
