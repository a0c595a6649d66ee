// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/render/cost.hpp"

#include <epoxy/gl.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "client/render/gl/gl_object.hpp"
#include "client/render/gl/render_target.hpp"
#include "client/render/scene_renderer.hpp"
#include "client/render/views/view_table.hpp"

namespace eti::bench {

namespace {

std::uint64_t sent = 0;  // bytes, while an Upload exists
decltype(epoxy_glBufferData) buffer_data;
decltype(epoxy_glBufferSubData) buffer_sub_data;

void counted_buffer_data(GLenum target, GLsizeiptr size, const void* data, GLenum usage) {
    sent += data != nullptr ? static_cast<std::uint64_t>(size) : 0;
    buffer_data(target, size, data, usage);
}

void counted_buffer_sub_data(GLenum target, GLintptr offset, GLsizeiptr size, const void* data) {
    sent += static_cast<std::uint64_t>(size);
    buffer_sub_data(target, offset, size, data);
}

/// Counts bytes written to buffers of the graphics card during its lifetime. libepoxy calls OpenGL through
/// pointers that it resolves on the first call, so one call must precede.
class Upload {
  public:
    Upload() {
        sent = 0;
        buffer_data = std::exchange(epoxy_glBufferData, counted_buffer_data);
        buffer_sub_data = std::exchange(epoxy_glBufferSubData, counted_buffer_sub_data);
    }
    ~Upload() {
        epoxy_glBufferData = buffer_data;
        epoxy_glBufferSubData = buffer_sub_data;
    }
    Upload(const Upload&) = delete;
    Upload& operator=(const Upload&) = delete;
    [[nodiscard]] std::uint64_t bytes() const { return sent; }
};

double median(std::vector<double> values) {
    std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
    return values[values.size() / 2];
}

// [ms] of processor time of all threads of this process.
double processor_ms() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

}  // namespace

std::vector<Cost> costs(const view::SceneView& a, const view::SceneView& b, int width, int height,
                        int pictures, const render::Quality& quality) {
    using Clock = std::chrono::steady_clock;
    const auto since = [](Clock::time_point begin) {
        return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
    };
    const render::RenderTarget target(width, height, quality.samples);
    render::SceneRenderer renderer(quality);
    std::vector<Cost> all;
    for (const render::View& view : render::views()) {
        const auto draw = [&](const view::SceneView& scene) {
            renderer.draw(view, scene, target, {0, 0, width, height});
            glFinish();
        };
        for (const view::SceneView* scene : {&a, &b}) {
            renderer.sync(*scene);
            draw(*scene);
        }
        // From here on libepoxy has resolved both functions.
        const float nothing = 0.0f;
        const render::Buffer buffer;
        glBindBuffer(GL_ARRAY_BUFFER, buffer.name());
        glBufferData(GL_ARRAY_BUFFER, sizeof nothing, &nothing, GL_STREAM_DRAW);
        glBufferSubData(GL_ARRAY_BUFFER, 0, sizeof nothing, &nothing);
        const Upload upload;
        std::vector<double> sync, drawn, whole, cpu;
        for (int i = 0; i < pictures; ++i) {
            const view::SceneView& scene = i % 2 == 0 ? a : b;
            const auto begin = Clock::now();
            const double cpu_begin = processor_ms();
            renderer.sync(scene);
            sync.push_back(since(begin));
            const auto synced = Clock::now();
            draw(scene);
            drawn.push_back(since(synced));
            whole.push_back(since(begin));
            cpu.push_back(processor_ms() - cpu_begin);
        }
        all.push_back({.view = std::string(view.name),
                       .width = width,
                       .height = height,
                       .sync_ms = median(sync),
                       .draw_ms = median(drawn),
                       .cpu_ms = median(cpu),
                       .slowest_ms = std::ranges::max(whole),
                       .kilobytes = 1e-3 * static_cast<double>(upload.bytes()) / pictures});
    }
    return all;
}

}  // namespace eti::bench
