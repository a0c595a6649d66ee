// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/security/permit.hpp"

#include <fmt/format.h>
#include <fnmatch.h>
#include <tinyxml2.h>

#include <algorithm>
#include <charconv>
#include <stdexcept>

namespace eti::bus {

namespace {

using tinyxml2::XMLElement;

const XMLElement& child(const XMLElement& parent, const char* name) {
    const XMLElement* found = parent.FirstChildElement(name);
    if (found == nullptr) {
        throw std::runtime_error(
            fmt::format("line {}: <{}> without <{}>", parent.GetLineNum(), parent.Name(), name));
    }
    return *found;
}

std::string text_of(const XMLElement& element) {
    return element.GetText() != nullptr ? element.GetText() : "";
}

template <class Use>
void each(const XMLElement& parent, const char* name, const Use& use) {
    for (const XMLElement* one = parent.FirstChildElement(name); one != nullptr;
         one = one->NextSiblingElement(name)) {
        use(*one);
    }
}

std::time_t moment_of(const XMLElement& element) {
    std::tm parts{};
    parts.tm_isdst = -1;
    const std::string text = text_of(element);
    if (::strptime(text.c_str(), "%Y-%m-%dT%H:%M:%S", &parts) == nullptr) {
        throw std::runtime_error(fmt::format("line {}: '{}' is not a date such as 2026-01-31T00:00:00",
                                             element.GetLineNum(), text.substr(0, 40)));
    }
    return std::mktime(&parts);
}

int number_of(const XMLElement& element) {
    const std::string text = text_of(element);
    int number = -1;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || stop != text.data() + text.size()) {
        throw std::runtime_error(
            fmt::format("line {}: '{}' is not a domain", element.GetLineNum(), text.substr(0, 40)));
    }
    return number;
}

std::vector<std::pair<int, int>> domains_of(const XMLElement& rule) {
    std::vector<std::pair<int, int>> domains;
    const XMLElement& element = child(rule, "domains");
    each(element, "id", [&](const XMLElement& one) { domains.emplace_back(number_of(one), number_of(one)); });
    each(element, "id_range", [&](const XMLElement& range) {
        domains.emplace_back(number_of(child(range, "min")), number_of(child(range, "max")));
    });
    return domains;
}

std::vector<Criteria> criteria_of(const XMLElement& rule, const char* kind) {
    std::vector<Criteria> all;
    each(rule, kind, [&](const XMLElement& element) {
        Criteria criteria;
        each(element, "topics", [&](const XMLElement& topics) {
            each(topics, "topic",
                 [&](const XMLElement& topic) { criteria.topics.push_back(text_of(topic)); });
        });
        each(element, "partitions", [&](const XMLElement& partitions) {
            each(partitions, "partition",
                 [&](const XMLElement& partition) { criteria.partitions.push_back(text_of(partition)); });
        });
        all.push_back(std::move(criteria));
    });
    return all;
}

bool fits(const std::vector<std::string>& patterns, const std::string& name) {
    return std::ranges::any_of(patterns, [&](const std::string& pattern) {
        return ::fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
    });
}

bool fits(const Rule& rule, int domain) {
    return std::ranges::any_of(
        rule.domains, [&](const auto& range) { return range.first <= domain && domain <= range.second; });
}

}  // namespace

bool Permit::domain(int number) const {
    return std::ranges::any_of(rules, [&](const Rule& rule) { return fits(rule, number); });
}

bool Permit::partition(int domain, const std::string& name) const {
    const auto allows = [&](const Criteria& criteria) { return fits(criteria.partitions, name); };
    return std::ranges::any_of(rules, [&](const Rule& rule) {
        return fits(rule, domain) &&
               (std::ranges::any_of(rule.publish, allows) || std::ranges::any_of(rule.subscribe, allows));
    });
}

bool Permit::topic(int domain, const std::string& partition, const std::string& name, bool write) const {
    return std::ranges::any_of(rules, [&](const Rule& rule) {
        return fits(rule, domain) &&
               std::ranges::any_of(write ? rule.publish : rule.subscribe, [&](const Criteria& criteria) {
                   return fits(criteria.topics, name) && fits(criteria.partitions, partition);
               });
    });
}

std::vector<Permit> read_permits(std::string_view document) {
    tinyxml2::XMLDocument xml;
    if (xml.Parse(document.data(), document.size()) != tinyxml2::XML_SUCCESS ||
        xml.RootElement() == nullptr) {
        throw std::runtime_error(fmt::format("line {}: not XML", xml.ErrorLineNum()));
    }
    std::vector<Permit> permits;
    each(child(*xml.RootElement(), "permissions"), "grant", [&](const XMLElement& grant) {
        Permit permit;
        permit.subject = text_of(child(grant, "subject_name"));
        const XMLElement& validity = child(grant, "validity");
        permit.from = moment_of(child(validity, "not_before"));
        permit.until = moment_of(child(validity, "not_after"));
        each(grant, "allow_rule", [&](const XMLElement& rule) {
            permit.rules.push_back(
                {domains_of(rule), criteria_of(rule, "publish"), criteria_of(rule, "subscribe")});
        });
        permits.push_back(std::move(permit));
    });
    return permits;
}

}  // namespace eti::bus
