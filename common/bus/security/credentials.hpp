// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <openssl/evp.h>
#include <openssl/x509.h>

#include <ctime>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

namespace eti::bus {

/// An unusable file of an identity; the text names the file, the problem and the remedy.
class CredentialError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// The remedy for a file that cannot be repaired by hand.
inline constexpr const char* renew_remedy = "renew it with deploy/security/make_lab.sh --renew";

struct FreeCertificate {
    void operator()(X509* certificate) const { X509_free(certificate); }
};
using Certificate = std::unique_ptr<X509, FreeCertificate>;

struct FreeKey {
    void operator()(EVP_PKEY* key) const { EVP_PKEY_free(key); }
};
using Key = std::unique_ptr<EVP_PKEY, FreeKey>;

/// From PEM. Throws CredentialError.
[[nodiscard]] Certificate read_certificate(const std::filesystem::path& file);
[[nodiscard]] Key read_key(const std::filesystem::path& file);

/// In RFC 2253 form: "CN=observer,OU=observer,O=NeoETI lab".
[[nodiscard]] std::string subject_of(const X509& certificate);
/// An attribute of the subject by its short name, such as "CN"; empty when there is none.
[[nodiscard]] std::string subject_attribute(const std::string& subject, const std::string& name);

[[nodiscard]] std::time_t valid_from(const X509& certificate);
[[nodiscard]] std::time_t valid_until(const X509& certificate);

/// Why `authority` did not sign `certificate`; empty if it did. Ignores dates.
[[nodiscard]] std::string signature_error(X509& certificate, X509& authority);

/// The text of an S/MIME document signed by `authority`. Ignores dates. Throws CredentialError.
[[nodiscard]] std::string read_signed_text(const std::filesystem::path& file, X509& authority);

}  // namespace eti::bus
