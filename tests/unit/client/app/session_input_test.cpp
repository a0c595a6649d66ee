// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/session_input.hpp"

#include <gtest/gtest.h>

#include "synthetic_server.hpp"

namespace eti {
namespace {

using namespace std::chrono_literals;

// Processes input until `enough`, or until the timeout.
template <class Enough>
void follow(client::SessionInput& input, view::SceneView& scene, Enough enough) {
    const auto limit = std::chrono::steady_clock::now() + 120s;
    while (!enough() && std::chrono::steady_clock::now() < limit) {
        input.receive_into(scene);
        input.wait(10ms);
    }
}

TEST(SessionInput, LateObserverReceivesRunSummary) {
    synthetic::SyntheticServer server(0.1);
    bus::Node node(synthetic::bus_options("eti-client"));
    view::SceneView early_scene, late_scene;
    client::SessionInput early(node, false, false);
    follow(early, early_scene, [&] { return early_scene.run_report().has_value(); });
    ASSERT_TRUE(early_scene.run_report());
    client::SessionInput late(node, false, false);
    follow(late, late_scene, [&] { return late_scene.run_report() && late_scene.attempt_report(); });
    ASSERT_TRUE(late_scene.run_report());
    ASSERT_TRUE(late_scene.attempt_report());
    EXPECT_EQ(late_scene.attempt_report()->attempt, 1u);
    EXPECT_TRUE(late_scene.run_report()->outcome.success);
}

TEST(SessionInput, ListsConsecutiveScenarios) {
    bus::Node server(synthetic::bus_options("eti-server")), node(synthetic::bus_options("eti-client"));
    bus::Publisher<msg::SessionDescription> publisher(server, bus::topics::session_description);
    client::SessionInput input(node, false, false);
    view::SceneView scene;
    msg::SessionDescription description = synthetic::make_scene().description;
    std::vector<std::string> expected;
    for (const char* const scenario : {"term", "term_enhanced"}) {
        description.scenario(scenario);
        description.header(bus::make_header(0, static_cast<std::uint32_t>(expected.size() + 1)));
        publisher.publish(description);
        expected.emplace_back(scenario);
        follow(input, scene, [&] { return input.scenarios().size() == expected.size(); });
        EXPECT_EQ(input.scenarios(), expected);
    }
}

}  // namespace
}  // namespace eti
