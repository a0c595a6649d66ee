// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/bus/codec/convert.hpp"
#include "common/scenario/data_file.hpp"
#include "common/scenario/setting.hpp"
#include "devices/app/command_link.hpp"
#include "devices/app/program.hpp"
#include "devices/app/session_list.hpp"
#include "devices/sensor/sensor_monitor.hpp"

namespace eti::devices {
namespace {

constexpr std::chrono::milliseconds period{20};  // 50 commands a second at most
constexpr std::chrono::milliseconds final_answer_timeout{500};

/// Maps the pad to commands and reports the server's answers.
class Controller {
  public:
    explicit Controller(const ProgramOptions& options)
        : options_(options),
          sensor_(find_driver(options.device, DeviceRole::commands).open(setup_of(options))),
          watch_(*sensor_),
          link_(options.bus) {}

    void run() {
        auto last = std::chrono::steady_clock::now();
        const auto begun = last;
        bool lost = false;
        while (ended_.empty()) {
            std::this_thread::sleep_for(period);
            const auto now = std::chrono::steady_clock::now();
            const float elapsed = std::chrono::duration<float>(now - last).count();
            last = now;
            watch_.poll_events();
            const Reading reading = watch_.exchange({}, elapsed);
            link_.poll();
            if (link_.has_server() != served_) {
                served_ = !served_;
                served_ ? spdlog::info("a server accepts commands")
                        : spdlog::warn("no server accepts commands any more");
                pad_.resend_held_inputs();
            }
            // Without a server a command would be lost silently: held inputs are sent when a server appears.
            if (served_) {
                if (link_.patient()) {
                    pad_.follow(*link_.patient());
                }
                for (const PadCommand& command : pad_.update(reading, elapsed)) {
                    link_.send(command);
                }
            }
            if (link_.session_finished()) {
                ended_ = "session finished";
            }
            if (watch_.health().lost != lost) {
                lost = !lost;
                lost ? spdlog::warn("device '{}' lost: {}", options_.device, watch_.fault())
                     : spdlog::info("device '{}' is back", options_.device);
            }
            if (stop_requested()) {
                ended_ = "interrupted";
            } else if (options_.duration > 0.0 &&
                       std::chrono::duration<double>(now - begun).count() >= options_.duration) {
                ended_ = "duration";
            }
        }
        for (const PadCommand& command : pad_.release()) {
            if (link_.has_server()) {
                link_.send(command);
                (void)link_.wait_for_answers(final_answer_timeout);
            }
        }
    }

    [[nodiscard]] nlohmann::ordered_json result() const {
        return {{"device", options_.device}, {"session", options_.bus.session}, {"ended", ended_},
                {"commands", link_.sent()},  {"accepted", link_.accepted()},    {"refused", link_.refused()}};
    }

  private:
    static SensorSetup setup_of(const ProgramOptions& options) {
        SensorSetup setup;
        setup.source = options.source;
        return setup;
    }

    ProgramOptions options_;
    std::unique_ptr<Sensor> sensor_;
    SensorMonitor watch_;
    CommandPad pad_;
    CommandLink link_;
    bool served_ = false;
    std::string ended_;
};

/// Waits for a server that is `ready`; throws if there is none after ten seconds.
template <class Ready>
void wait_for_server(const ProgramOptions& options, const Ready& ready) {
    const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (!ready()) {
        if (std::chrono::steady_clock::now() > limit) {
            throw bus::BusError(bus::missing_server_message(options.bus));
        }
        std::this_thread::sleep_for(period);
    }
}

/// The session's description with the current values.
nlohmann::ordered_json list_once(const ProgramOptions& options) {
    CommandLink link(options.bus);
    wait_for_server(options, [&] {
        link.poll();
        return link.description() && !link.now().empty();
    });
    return session_list(*link.description(), link.now());
}

/// Adds a note to the session's record.
nlohmann::ordered_json note_once(const ProgramOptions& options, const std::string& text) {
    bus::Node node(options.bus);
    bus::Publisher<msg::Annotation> notes(node, bus::topics::annotation);
    wait_for_server(options, [&] {
        bus::refuse_other_protocol(node);
        return notes.matched() > 0;
    });
    msg::Annotation note;
    note.header(bus::make_header(0, 1));
    note.sender(bus::process_name().substr(0, msg::bound::Annotation_sender));
    note.kind(msg::ANNOTATION_NOTE);
    note.text(text);
    const bool received = notes.publish(note) && notes.wait_until_received(final_answer_timeout);
    return {{"session", options.bus.session},
            {"ended", received ? "noted" : "the server did not accept the note"}};
}

/// Sends the typed commands and waits for the answers.
nlohmann::ordered_json set_once(const ProgramOptions& options, const std::vector<PadCommand>& wanted) {
    using namespace std::chrono_literals;
    CommandLink link(options.bus);
    wait_for_server(options, [&] {
        link.poll();
        return link.has_server();
    });
    for (const PadCommand& command : wanted) {
        link.send(command);
    }
    const bool answered = link.wait_for_answers(5s);
    return {{"session", options.bus.session},
            {"ended", answered ? "answered" : "the server did not answer"},
            {"commands", link.sent()},
            {"accepted", link.accepted()},
            {"refused", link.refused()}};
}

/// One-shot requests of the command line.
struct Once {
    std::string command;             ///< without a value
    std::optional<float> seek;       ///< [s]
    std::string preset;              ///< by name or path
    std::vector<std::string> typed;  ///< KEY=VALUE
};
constexpr std::array<std::string_view, 5> plain_commands{"start", "stop", "reset", "next", "pause"};

int run(const ProgramOptions& options, const Once& once, const std::string& remark, bool list) {
    if (list) {
        const nlohmann::ordered_json session = list_once(options);
        print_json(options.json, session);
        std::cout << (options.json ? "" : session_text(session));
        return 0;
    }
    if (!remark.empty()) {
        const nlohmann::ordered_json noted = note_once(options, remark);
        print_json(options.json, noted);
        return noted["ended"] == "noted" ? 0 : 1;
    }
    if (options.device.empty() && once.typed.empty() && once.preset.empty() && once.command.empty() &&
        !once.seek) {
        throw InputError(
            "expected one of --device, --set, --preset, --command, --seek, --note or --list; see --help");
    }
    nlohmann::ordered_json result;
    bool well = true;
    if (options.device.empty()) {
        std::vector<PadCommand> wanted;
        if (!once.preset.empty()) {
            wanted = commands_of_preset(once.preset);
        }
        if (const auto plain = std::ranges::find(plain_commands, once.command);
            plain != plain_commands.end()) {
            wanted.push_back({*plain, 1.0f});
        }
        if (once.seek) {
            wanted.push_back({"seek", *once.seek});
        }
        std::ranges::transform(once.typed, std::back_inserter(wanted), command_from);
        result = set_once(options, wanted);
        well = result["accepted"] == wanted.size();
    } else {
        Controller controller(options);
        spdlog::info("commands from '{}' to session '{}'", options.device, options.bus.session);
        controller.run();
        result = controller.result();
        spdlog::info("ended: {}; {} commands, {} accepted, {} refused", result["ended"].get<std::string>(),
                     result["commands"].get<int>(), result["accepted"].get<int>(),
                     result["refused"].get<int>());
    }
    print_json(options.json, result);
    return well ? 0 : 1;
}

}  // namespace
}  // namespace eti::devices

int main(int argc, char** argv) {
    using namespace eti::devices;
    ProgramOptions options;
    options.bus.name = "eti-controller";
    eti::CommandLine app(
        "Sends commands to a session: continuously from a gamepad or the keyboard, or once those given as "
        "options.",
        "eti-controller");
    app.footer(
        "Gamepad: trigger or first button suction, left stick up and down head elevation, left and right jaw "
        "opening, right stick up and down table (up: head-up), right stick right and left more and less "
        "pressure "
        "on the larynx backwards, directional pad the same up, down and to the sides.\n"
        "Keyboard: s suction, arrows up and down head elevation, left and right jaw opening, ] and [ table, "
        "b "
        "and v more and less pressure on the larynx backwards, i, k, j and l the same up, down and to the "
        "patient's left and right.\n"
        "Keys of --set: " +
        eti::runtime_parameter_help() + ". Exit status 0 only if the server accepted all commands.");
    add_device_options(app, options, DeviceRole::commands);
    Once once;
    const auto device = app.option("--device").required(false);
    const auto set = app.add_option("--set", once.typed,
                                    "KEY=VALUE, may be repeated: send these, wait for the answers and exit")
                         .excludes(device);
    const auto choice =
        app.add_option("--preset", once.preset,
                       "Send the values of this preset, by name or path; --set overrides them")
            .excludes(device);
    const auto plain =
        app.add_option("--command", once.command,
                       "start; stop: end the session; reset: tissue and tube to rest; next: start the next "
                       "session, if the server was given several scenarios; pause: pause a replay")
            .one_of(std::vector<std::string>(plain_commands.begin(), plain_commands.end()))
            .excludes(device);
    const auto place = app.add_number("--seek", once.seek, "Time to which a replay seeks", {0.0f, 1e7f, "s"})
                           .excludes(device);
    bool list = false;
    const auto listing =
        app.add_flag("--list", list, "Print the session's description with all runtime parameters, and exit")
            .excludes(device)
            .excludes(set)
            .excludes(choice)
            .excludes(plain)
            .excludes(place);
    std::string remark;
    app.add_option("--note", remark,
                   "Add this remark of at most 200 letters to the session's recording, and exit")
        .excludes(device)
        .excludes(set)
        .excludes(choice)
        .excludes(plain)
        .excludes(place)
        .excludes(listing)
        .check([](const std::string& text) {
            return !text.empty() && text.size() <= msg::bound::Annotation_text
                       ? std::string()
                       : "a remark has 1 to 200 letters";
        });
    add_bus_options(app, options);
    return eti::run_program(
        app, argc, argv, [&] { return run(options, once, remark, list); }, device_signals);
}
