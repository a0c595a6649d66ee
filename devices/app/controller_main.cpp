// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/bus/convert.hpp"
#include "devices/app/command_pad.hpp"
#include "devices/app/program.hpp"
#include "devices/sensor/sensor_watch.hpp"

namespace eti::devices {
namespace {

constexpr std::chrono::milliseconds period{20};  // 50 commands a second at most

/// Turns what a thumb does into commands and says how the server answers.
class Controller {
  public:
    Controller(const ProgramOptions& options, const PadCommands& start)
        : options_(options),
          sensor_(driver_named(options.device, Use::commands).open(setup_of(options))),
          watch_(*sensor_),
          pad_(start),
          node_(options.bus),
          commands_(node_, bus::topics::command),
          answers_(node_, bus::topics::command_result),
          status_(node_, bus::topics::session_status) {}

    void run(const volatile std::sig_atomic_t& stop) {
        auto last = std::chrono::steady_clock::now();
        const auto begun = last;
        bool lost = false;
        while (ended_.empty()) {
            std::this_thread::sleep_for(period);
            const auto now = std::chrono::steady_clock::now();
            const float elapsed = std::chrono::duration<float>(now - last).count();
            last = now;
            watch_.tend();
            const Reading reading = watch_.exchange({}, elapsed);
            // A command that nobody takes would be lost without a word: what is held now is sent when
            // a server is there.
            if (commands_.matched() > 0) {
                for (const PadCommand& command : pad_.update(reading, elapsed)) {
                    send(command);
                }
            }
            if ((commands_.matched() > 0) != served_) {
                served_ = !served_;
                served_ ? spdlog::info("a server takes commands")
                        : spdlog::warn("no server takes commands any more");
            }
            hear();
            if (watch_.health().lost != lost) {
                lost = !lost;
                lost ? spdlog::warn("device '{}' is lost: {}", options_.device, watch_.fault())
                     : spdlog::info("device '{}' is back", options_.device);
            }
            if (stop != 0) {
                ended_ = "interrupted";
            } else if (options_.duration > 0.0 &&
                       std::chrono::duration<double>(now - begun).count() >= options_.duration) {
                ended_ = "duration";
            }
        }
    }

    [[nodiscard]] nlohmann::ordered_json result() const {
        return {{"device", options_.device}, {"session", options_.bus.session}, {"ended", ended_},
                {"commands", sent_},         {"accepted", accepted_},           {"refused", refused_}};
    }

  private:
    static SensorSetup setup_of(const ProgramOptions& options) {
        SensorSetup setup;
        setup.source = options.source;
        return setup;
    }

    void send(const PadCommand& command) {
        msg::Command message;
        message.header(bus::make_header(0, ++sent_));
        message.sender(sender_);
        message.id(sent_);
        message.kind(command.kind);
        message.value(command.value);
        if (!commands_.publish(message)) {
            spdlog::warn("a command could not be sent: no server takes it");
        }
    }

    void hear() {
        msg::CommandResult answer;
        while (answers_.take(answer)) {
            if (answer.recipient().to_string() != sender_) {
                continue;
            }
            ++(answer.accepted() ? accepted_ : refused_);
            if (!answer.accepted()) {
                spdlog::warn("refused: {}", answer.reason().to_string());
            }
        }
        msg::SessionStatus status;
        while (status_.take(status)) {
            if (status.phase() == msg::PHASE_FINISHED) {
                ended_ = "session finished";
            }
        }
    }

    ProgramOptions options_;
    std::string sender_ = "eti-controller:" + std::to_string(::getpid());
    std::unique_ptr<Sensor> sensor_;
    SensorWatch watch_;
    CommandPad pad_;
    bus::Node node_;
    bus::Publisher<msg::Command> commands_;
    bus::Subscriber<msg::CommandResult> answers_;
    bus::Subscriber<msg::SessionStatus> status_;
    bool served_ = false;
    std::string ended_;
    std::uint32_t sent_ = 0, accepted_ = 0, refused_ = 0;
};

}  // namespace
}  // namespace eti::devices

int main(int argc, char** argv) {
    using namespace eti::devices;
    set_up_process("eti-controller");
    ProgramOptions options;
    options.bus.name = "eti-controller";
    PadCommands start;
    CLI::App app("Commands from a pad or the keyboard: suction, head elevation, jaw opening.",
                 "eti-controller");
    app.footer(
        "Pad: trigger or first button suction, left stick up and down head elevation, left and right jaw "
        "opening.\n"
        "Keyboard: s suction, arrows up and down head elevation, left and right jaw opening.");
    app.set_version_flag("--version", ETI_VERSION);
    add_device_options(app, options, Use::commands);
    app.add_option("--head-elevation-deg", start.head_elevation_deg, "Where the head begins")
        ->capture_default_str();
    app.add_option("--jaw-opening-deg", start.jaw_opening_deg, "Where the jaw begins")->capture_default_str();
    add_bus_options(app, options);
    if (const auto code = parse(app, argc, argv)) {
        return *code;
    }
    try {
        Controller controller(options, start);
        spdlog::info("commands from '{}' to session '{}'", options.device, options.bus.session);
        controller.run(stop_flag());
        const auto result = controller.result();
        spdlog::info("ended: {}; {} commands, {} accepted, {} refused", result["ended"].get<std::string>(),
                     result["commands"].get<int>(), result["accepted"].get<int>(),
                     result["refused"].get<int>());
        if (options.json) {
            std::cout << result.dump(2) << std::endl;
        }
        return 0;
    } catch (const std::exception& error) {
        spdlog::error("{}", error.what());
        return 1;
    }
}
