// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/fastdds/settings.hpp"

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#if ETI_FASTDDS >= 3
#include <fastdds/LibrarySettings.hpp>
#include <fastdds/config.hpp>
#include <fstream>
#include <iterator>
#else
#include <fastrtps/attributes/LibrarySettingsAttributes.h>
#include <fastrtps/config.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>
#endif

#include "common/bus/library_log.hpp"

namespace eti::bus {

#if ETI_FASTDDS >= 3

std::string library_version() {
    return FASTDDS_VERSION_STR;
}

void turn_off_intraprocess_delivery() {
    auto* factory = dds::DomainParticipantFactory::get_instance();
    eprosima::fastdds::LibrarySettings settings;
    (void)factory->get_library_settings(settings);
    settings.intraprocess_delivery = eprosima::fastdds::INTRAPROCESS_OFF;
    (void)factory->set_library_settings(settings);
}

ProfileResult read_profile(const std::filesystem::path& file, const std::string& name,
                           dds::DomainParticipantQos& qos) {
    std::ifstream in(file, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    auto* factory = dds::DomainParticipantFactory::get_instance();
    if (succeeded(factory->get_participant_qos_from_xml(text, qos, name))) {
        return ProfileResult::found;
    }
    // The code is the same for a file without the profile and for an invalid one.
    dds::DomainParticipantQos any;
    return succeeded(factory->get_participant_qos_from_xml(text, any)) ? ProfileResult::no_such_profile
                                                                       : ProfileResult::invalid_file;
}

void add_discovery_server(const rtps::Locator_t& locator, const std::string& /*guid_prefix*/,
                          dds::DomainParticipantQos& qos) {
    auto& config = qos.wire_protocol().builtin.discovery_config;
    config.discoveryProtocol = rtps::DiscoveryProtocol::CLIENT;
    config.m_DiscoveryServers.push_back(locator);
}

void make_discovery_server(dds::DomainParticipantQos& qos) {
    qos.wire_protocol().builtin.discovery_config.discoveryProtocol = rtps::DiscoveryProtocol::SERVER;
}

#else

std::string library_version() {
    return FASTRTPS_VERSION_STR;
}

void turn_off_intraprocess_delivery() {
    using Manager = eprosima::fastrtps::xmlparser::XMLProfileManager;
    auto settings = Manager::library_settings();
    settings.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
    Manager::library_settings(settings);
}

ProfileResult read_profile(const std::filesystem::path& file, const std::string& name,
                           dds::DomainParticipantQos& qos) {
    // The library keeps the first profile of a name; another node of this process may use another file.
    eprosima::fastrtps::xmlparser::XMLProfileManager::DeleteInstance();
    auto* factory = dds::DomainParticipantFactory::get_instance();
    if (!succeeded(factory->load_XML_profiles_file(file.string()))) {
        return ProfileResult::invalid_file;
    }
    return succeeded(factory->get_participant_qos_from_profile(name, qos)) ? ProfileResult::found
                                                                           : ProfileResult::no_such_profile;
}

void add_discovery_server(const rtps::Locator_t& locator, const std::string& guid_prefix,
                          dds::DomainParticipantQos& qos) {
    auto& config = qos.wire_protocol().builtin.discovery_config;
    config.discoveryProtocol = rtps::DiscoveryProtocol_t::CLIENT;
    rtps::RemoteServerAttributes attributes;
    attributes.ReadguidPrefix(guid_prefix.c_str());
    attributes.metatrafficUnicastLocatorList.push_back(locator);
    config.m_DiscoveryServers.push_back(attributes);
}

void make_discovery_server(dds::DomainParticipantQos& qos) {
    qos.wire_protocol().builtin.discovery_config.discoveryProtocol = rtps::DiscoveryProtocol_t::SERVER;
}

#endif

}  // namespace eti::bus
