// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/log.hpp"

#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <memory>

#include "common/process/escaped.hpp"

namespace eti {

namespace {

class EscapingFormatter : public spdlog::formatter {
  public:
    void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& out) override {
        const std::string text = escaped_lines({message.payload.data(), message.payload.size()});
        spdlog::details::log_msg shown = message;
        shown.payload = text;
        usual_.format(shown, out);
        message.color_range_start = shown.color_range_start;
        message.color_range_end = shown.color_range_end;
    }
    [[nodiscard]] std::unique_ptr<spdlog::formatter> clone() const override {
        return std::make_unique<EscapingFormatter>();
    }

  private:
    spdlog::pattern_formatter usual_;
};

}  // namespace

void set_up_log(const std::string& program) {
    const auto logger = spdlog::stderr_color_mt(program);
    logger->set_formatter(std::make_unique<EscapingFormatter>());
    spdlog::set_default_logger(logger);
}

}  // namespace eti
