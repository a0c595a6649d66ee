// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "deploy/doctor/graphics.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>

#include "common/process/files/descriptor.hpp"

namespace eti::doctor {

namespace {

namespace fs = std::filesystem;

// Constants of EGL 1.5, EGL_MESA_platform_surfaceless and OpenGL; a server has no such headers.
constexpr int platform_surfaceless = 0x31DD, opengl_api = 0x30A2, renderer_name = 0x1F01;
constexpr std::array<int, 5> context_of_3_3{0x3098, 3, 0x30FB, 3, 0x3038};
constexpr unsigned longest_s = 20;  // time limit for a hung driver

using Pointer = void*;

struct Library {
    explicit Library(const char* name) : handle(::dlopen(name, RTLD_NOW | RTLD_LOCAL)) {}
    template <class Function>
    [[nodiscard]] Function* get(const char* name) const {
        return reinterpret_cast<Function*>(::dlsym(handle, name));
    }
    void* handle;  // never closed: drivers do not support unloading
};

/// "+renderer" or "-fault".
std::string try_egl() {
    const Library egl("libEGL.so.1");
    if (egl.handle == nullptr) {
        return "-libEGL.so.1 is not installed";
    }
    const auto address = egl.get<Pointer(const char*)>("eglGetProcAddress");
    const auto initialize = egl.get<unsigned(Pointer, int*, int*)>("eglInitialize");
    const auto bind = egl.get<unsigned(unsigned)>("eglBindAPI");
    const auto create = egl.get<Pointer(Pointer, Pointer, Pointer, const int*)>("eglCreateContext");
    const auto current = egl.get<unsigned(Pointer, Pointer, Pointer, Pointer)>("eglMakeCurrent");
    if (address == nullptr || initialize == nullptr || bind == nullptr || create == nullptr ||
        current == nullptr) {
        return "-libEGL.so.1 is not an EGL library";
    }
    const auto display_of =
        reinterpret_cast<Pointer (*)(unsigned, Pointer, const int*)>(address("eglGetPlatformDisplayEXT"));
    const Pointer display =
        display_of != nullptr ? display_of(platform_surfaceless, nullptr, nullptr) : nullptr;
    if (display == nullptr || initialize(display, nullptr, nullptr) == 0) {
        return "-EGL offers no surfaceless display";
    }
    bind(opengl_api);
    const Pointer context = create(display, nullptr, nullptr, context_of_3_3.data());
    if (context == nullptr || current(display, nullptr, nullptr, context) == 0) {
        return "-the driver provides no OpenGL 3.3 context";
    }
    const auto get_string = reinterpret_cast<const char* (*)(unsigned)>(address("glGetString"));
    const char* name = get_string != nullptr ? get_string(renderer_name) : nullptr;
    return name != nullptr ? std::string("+") + name : "-the driver does not report its name";
}

}  // namespace

Findings graphics() {
    std::array<int, 2> pipe{};
    if (::pipe(pipe.data()) != 0) {
        return {diagnose_renderer("", "no pipe could be opened")};
    }
    const Descriptor reading(pipe[0]);
    Descriptor writing(pipe[1]);
    const pid_t child = ::fork();
    if (child == 0) {
        ::alarm(longest_s);
        const std::string said = try_egl();
        const auto written = ::write(writing.get(), said.data(), said.size());
        ::_exit(written > 0 ? 0 : 1);
    }
    writing.close();
    std::string said;
    std::array<char, 256> part{};
    for (ssize_t size = 0; (size = ::read(reading.get(), part.data(), part.size())) > 0;) {
        said.append(part.data(), static_cast<std::size_t>(size));
    }
    if (child > 0) {
        ::waitpid(child, nullptr, 0);
    }
    if (said.empty()) {
        return {diagnose_renderer("", "the driver crashed or hung")};
    }
    return {said.front() == '+' ? diagnose_renderer(said.substr(1), "")
                                : diagnose_renderer("", said.substr(1))};
}

Finding diagnose_renderer(const std::string& renderer, const std::string& fault) {
    if (renderer.empty()) {
        return {"graphics", "EGL", State::info, fault,
                "only eti-client needs it; install a driver: apt-get install libegl-mesa0 libgl1-mesa-dri, "
                "or the card's own"};
    }
    const bool in_software = renderer.find("llvmpipe") != std::string::npos ||
                             renderer.find("softpipe") != std::string::npos ||
                             renderer.find("swrast") != std::string::npos;
    if (in_software) {
        return {"graphics", "EGL", State::info, renderer + ": renders in software",
                "slow for a trainee's view; use a machine with a graphics card and its driver"};
    }
    return {"graphics", "EGL", State::ok, renderer, ""};
}

std::vector<fs::path> openxr_runtime_paths() {
    if (const char* named = std::getenv("XR_RUNTIME_JSON"); named != nullptr && *named != '\0') {
        return {named};
    }
    std::vector<fs::path> folders;
    const auto add = [&](const char* variable, const std::string& otherwise) {
        const char* set = std::getenv(variable);
        const std::string list = set != nullptr && *set != '\0' ? set : otherwise;
        for (std::size_t from = 0; from < list.size();) {
            const std::size_t end = std::min(list.find(':', from), list.size());
            if (end > from) {
                folders.emplace_back(list.substr(from, end - from));
            }
            from = end + 1;
        }
    };
    const char* home = std::getenv("HOME");
    add("XDG_CONFIG_HOME", home != nullptr ? std::string(home) + "/.config" : "");
    add("XDG_CONFIG_DIRS", "/etc/xdg");
    folders.emplace_back("/etc");
    for (fs::path& folder : folders) {
        folder /= "openxr/1/active_runtime.json";
    }
    return folders;
}

Finding diagnose_openxr(bool loader, const std::vector<fs::path>& searched) {
    std::error_code error;
    const auto found = std::ranges::find_if(
        searched, [&](const fs::path& file) { return fs::is_regular_file(file, error); });
    const char* needed = "only a headset needs it";
    if (!loader) {
        return {"graphics", "OpenXR", State::info, "libopenxr_loader.so.1 is not installed",
                fmt::format("{}; install it: apt-get install libopenxr-loader1", needed)};
    }
    if (found == searched.end()) {
        std::vector<std::string> names;
        std::ranges::transform(searched, std::back_inserter(names),
                               [](const fs::path& file) { return file.string(); });
        return {"graphics", "OpenXR", State::info,
                fmt::format("no active runtime; searched {}", fmt::join(names, ", ")),
                fmt::format("{}; start the headset's software once, or set XR_RUNTIME_JSON", needed)};
    }
    return {"graphics", "OpenXR", State::ok, fmt::format("runtime {}", found->string()), ""};
}

Findings openxr() {
    return {diagnose_openxr(Library("libopenxr_loader.so.1").handle != nullptr, openxr_runtime_paths())};
}

}  // namespace eti::doctor
