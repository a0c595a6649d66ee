// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/review/server_program.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <filesystem>
#include <iostream>

namespace eti::review {

void exec_server(const std::vector<std::string>& arguments) {
    std::vector<std::string> words{"eti-server"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> pointers;
    for (std::string& word : words) {
        pointers.push_back(word.data());
    }
    pointers.push_back(nullptr);
    std::error_code error;
    const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
    ::execv((self.parent_path() / "eti-server").c_str(), pointers.data());
    ::execvp("eti-server", pointers.data());
    std::cerr << "eti-review: eti-server, which simulates and publishes sessions, was found neither in "
              << self.parent_path().string() << " nor in PATH: install it (docs/packages.md)" << std::endl;
}

int run_server(const std::vector<std::string>& arguments) {
    constexpr int no_program = 127;
    std::cout.flush();
    const pid_t child = ::fork();
    if (child == 0) {
        const int nowhere = ::open("/dev/null", O_WRONLY);
        ::dup2(nowhere, STDOUT_FILENO);
        exec_server(arguments);
        ::_exit(no_program);
    }
    int status = 0;
    while (child > 0 && ::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return child < 0 ? no_program : WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

}  // namespace eti::review
