// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/security/identity_check.hpp"

#include <fmt/format.h>
#include <openssl/x509.h>

#include <algorithm>

#include "common/bus/security/credentials.hpp"
#include "common/bus/security/permit.hpp"
#include "common/bus/topics.hpp"

namespace eti::bus {

namespace fs = std::filesystem;

namespace {

/// Warns early enough that an identity does not expire in the middle of a course.
constexpr std::time_t soon = 14 * 24 * 3600;  // [s]

std::string sentence_of_time(const fs::path& file, const char* what, std::time_t from, std::time_t until,
                             std::time_t now) {
    if (now < from) {
        return fmt::format(
            "{}: {} is not valid before {} UTC, and this machine's clock shows {}; set the clock if it is "
            "wrong, otherwise wait, or {}",
            file.string(), what, date_text(from), date_text(now), renew_remedy);
    }
    if (now > until) {
        return fmt::format(
            "{}: {} expired on {} UTC, and this machine's clock shows {}; set the clock if it is wrong, "
            "otherwise {}",
            file.string(), what, date_text(until), date_text(now), renew_remedy);
    }
    return {};
}

/// Checks the six files of one identity in turn.
class Examination {
  public:
    Examination(fs::path folder, std::time_t now) : folder_(std::move(folder)), now_(now) {}

    IdentityCheck of(const std::string& session, int domain) {
        std::error_code error;
        if (!fs::is_directory(folder_, error)) {
            check_.faults.push_back(
                fmt::format("identity {}: no such folder; give one created by deploy/security/make_lab.sh",
                            folder_.string()));
            return check_;
        }
        const Certificate identity_authority = certificate("identity_ca.pem");
        const Certificate permissions_authority = certificate("permissions_ca.pem");
        const Certificate own = certificate("certificate.pem");
        if (identity_authority && permissions_authority &&
            X509_cmp(identity_authority.get(), permissions_authority.get()) == 0) {
            check_.faults.push_back(
                fmt::format("{}: is also the authority of identities, so that whoever has an identity of "
                            "this lab could sign "
                            "its own permissions; make the lab anew in an empty folder with "
                            "deploy/security/make_lab.sh, and "
                            "give its folders to every machine",
                            (folder_ / "permissions_ca.pem").string()));
        }
        check_certificate(own.get(), identity_authority.get());
        check_key(own.get());
        if (permissions_authority) {
            attempt([&] { (void)read_signed_text(folder_ / "governance.p7s", *permissions_authority); });
            check_permissions(own.get(), *permissions_authority, session, domain);
        }
        if (check_.faults.empty() && check_.until - now_ < soon) {
            check_.warnings.push_back(fmt::format("identity {}: expires on {} UTC; {}", folder_.string(),
                                                  date_text(check_.until), renew_remedy));
        }
        return check_;
    }

  private:
    template <class Work>
    void attempt(const Work& work) {
        try {
            work();
        } catch (const CredentialError& error) {
            check_.faults.emplace_back(error.what());
        }
    }

    Certificate certificate(const char* name) {
        Certificate read;
        attempt([&] { read = read_certificate(folder_ / name); });
        if (read) {
            hold_dates(name, "the certificate", valid_from(*read), valid_until(*read));
        }
        return read;
    }

    void hold_dates(const char* name, const char* what, std::time_t from, std::time_t until) {
        if (const std::string fault = sentence_of_time(folder_ / name, what, from, until, now_);
            !fault.empty()) {
            check_.faults.push_back(fault);
        }
        check_.until = check_.until == 0 ? until : std::min(check_.until, until);
    }

    void check_certificate(X509* own, X509* authority) {
        if (own == nullptr) {
            return;
        }
        const std::string subject = subject_of(*own);
        check_.name = subject_attribute(subject, "CN");
        check_.role = subject_attribute(subject, "OU");
        if (authority == nullptr) {
            return;
        }
        check_.authority = subject_attribute(subject_of(*authority), "CN");
        if (const std::string why = signature_error(*own, *authority); !why.empty()) {
            check_.faults.push_back(
                fmt::format("{}: was not signed by '{}' of identity_ca.pem ({}): they belong to different "
                            "labs; copy the identity's whole folder as make_lab.sh created it",
                            (folder_ / "certificate.pem").string(), check_.authority, why));
        }
    }

    void check_key(X509* own) {
        const fs::path file = folder_ / "key.pem";
        attempt([&] {
            const Key key = read_key(file);
            if (own != nullptr && X509_check_private_key(own, key.get()) != 1) {
                throw CredentialError(
                    fmt::format("{}: is not the key of certificate.pem ({}); copy the identity's whole "
                                "folder as make_lab.sh created it",
                                file.string(), subject_of(*own)));
            }
            const auto rights = fs::status(file).permissions();
            if ((rights & (fs::perms::group_read | fs::perms::others_read)) != fs::perms::none) {
                check_.warnings.push_back(
                    fmt::format("{}: other users of this machine can read the key; run: chmod 600 {}",
                                file.string(), file.string()));
            }
        });
    }

    void check_permissions(X509* own, X509& authority, const std::string& session, int domain) {
        const fs::path file = folder_ / "permissions.p7s";
        attempt([&] {
            const std::string document = read_signed_text(file, authority);
            std::vector<Permit> permits;
            try {
                permits = read_permits(document);
            } catch (const std::runtime_error& error) {
                throw CredentialError(
                    fmt::format("{}: signed, but not a permissions document of DDS Security ({}); {}",
                                file.string(), error.what(), renew_remedy));
            }
            if (own == nullptr) {
                return;
            }
            const std::string subject = subject_of(*own);
            const auto permit = std::ranges::find(permits, subject, &Permit::subject);
            if (permit == permits.end()) {
                throw CredentialError(fmt::format(
                    "{}: grants nothing to '{}' of certificate.pem, but to '{}'; copy the identity's whole "
                    "folder as make_lab.sh created it",
                    file.string(), subject, permits.empty() ? "no one" : permits.front().subject));
            }
            hold_dates("permissions.p7s", "the permission", permit->from, permit->until);
            if (!permit->domain(domain)) {
                throw CredentialError(
                    fmt::format("{}: does not allow domain {}; give another --domain, or renew the identity "
                                "with make_lab.sh --renew --domain {}",
                                file.string(), domain, domain));
            }
            if (!permit->partition(domain, partition_of(session))) {
                throw CredentialError(
                    fmt::format("{}: does not allow session '{}'; give another --session, or renew the "
                                "identity with make_lab.sh --renew --session {}",
                                file.string(), session, session));
            }
        });
    }

    fs::path folder_;
    std::time_t now_;
    IdentityCheck check_;
};

}  // namespace

std::string date_text(std::time_t when) {
    std::tm parts{};
    char text[32] = {};
    ::gmtime_r(&when, &parts);
    std::strftime(text, sizeof text, "%Y-%m-%d %H:%M", &parts);
    return text;
}

IdentityCheck check_identity(const fs::path& folder, const std::string& session, int domain,
                             std::time_t now) {
    return Examination(folder, now).of(session, domain);
}

}  // namespace eti::bus
