// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/library_log.hpp"

#include <spdlog/sinks/stdout_sinks.h>

#include <fastdds/dds/log/Log.hpp>
#include <memory>

#include "common/process/log_throttle.hpp"

namespace eti::bus {

namespace dds = eprosima::fastdds::dds;

namespace {

// By default the library logs to standard output, where the programs write their results.
class LogToStandardError final : public dds::LogConsumer {
  public:
    void Consume(const dds::Log::Entry& entry) override {
        // A cause is the reporting location in the library: its texts differ from peer to peer.
        const std::string cause = fmt::format("{}:{}:{}", text(entry.context.category),
                                              text(entry.context.filename), entry.context.line);
        const auto suppressed = limit_.allow(cause);
        if (!suppressed) {
            return;
        }
        const auto level = entry.kind == dds::Log::Error     ? spdlog::level::err
                           : entry.kind == dds::Log::Warning ? spdlog::level::warn
                                                             : spdlog::level::info;
        bus_log().log(level, "{}: {}{}", text(entry.context.category), entry.message,
                      suppressed_suffix(*suppressed));
    }

  private:
    static const char* text(const char* of) { return of != nullptr ? of : ""; }

    LogThrottle limit_;
};

}  // namespace

spdlog::logger& bus_log() {
    static const std::shared_ptr<spdlog::logger> logger = [] {
        auto known = spdlog::get("bus");
        return known ? known : spdlog::stderr_logger_mt("bus");
    }();
    return *logger;
}

void set_up_library_log() {
    (void)bus_log();
    dds::Log::ClearConsumers();
    dds::Log::RegisterConsumer(std::make_unique<LogToStandardError>());
    dds::Log::SetVerbosity(dds::Log::Error);
}

}  // namespace eti::bus
