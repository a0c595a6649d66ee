// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/offscreen/pictures.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>

#include "common/process/files/descriptor.hpp"

namespace eti::client {
namespace {

constexpr float better_by_percent = 0.5f;

[[noreturn]] void refuse(const std::filesystem::path& folder, const std::string& cause) {
    throw std::runtime_error(
        fmt::format("{}: cannot write pictures to this folder: {}. Choose another folder with --offscreen, "
                    "or make this one writable.",
                    folder.string(), cause));
}

}  // namespace

void prepare_folder(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) {
        refuse(folder, error.message());
    }
    const auto trial = folder / fmt::format(".written-{}", ::getpid());
    if (!Descriptor(::open(trial.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600))) {
        refuse(folder, std::strerror(errno));
    }
    std::filesystem::remove(trial, error);
}

std::string picture_name(std::string_view view, std::string_view occasion, double time_s) {
    return occasion.empty() ? fmt::format("{}_{:07.3f}s.png", view, time_s)
                            : fmt::format("{}_{}_{:07.3f}s.png", view, occasion, time_s);
}

void BestView::consider(const view::SceneView& scene) {
    const float percent = scene.measures().glottic_opening_percent;
    if (scene.complete() && percent > percent_ + better_by_percent) {
        percent_ = percent;
        scene_ = scene;
    }
}

void PictureWriter::take(Compositor& compositor, const Selection& selection, const view::SceneView& scene,
                         const hud::Readout& readout, const render::Vantage& from, std::string_view occasion,
                         const std::function<void()>& between) {
    const auto draw = [&](std::string_view name, const Views& views) {
        if (between) {
            between();
        }
        compositor.draw(views, scene, readout, from, false, selection.arrangement);
        const auto file = folder_ / picture_name(name, occasion, readout.time_s);
        render::write_png(compositor.target().read(), file);
        files_.push_back(file);
    };
    const Views& views = selection.views(scene);
    for (const render::View* view : views) {
        draw(view->name, {view});
    }
    if (views.size() > 1) {
        draw(selection.name, views);
    }
}

}  // namespace eti::client
