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

/// A file of an identity that cannot be used; the text names file, finding and remedy.
class CredentialError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// The remedy for a file that cannot be mended by hand.
inline constexpr const char* make_anew = "make it anew with deploy/security/make_lab.sh --renew";

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

/// As RFC 2253 writes it: "CN=observer,OU=observer,O=NeoETI lab".
[[nodiscard]] std::string subject_of(const X509& certificate);
/// A part of the subject, by its short name: "CN"; empty when there is none.
[[nodiscard]] std::string part_of(const std::string& subject, const std::string& name);

[[nodiscard]] std::time_t valid_from(const X509& certificate);
[[nodiscard]] std::time_t valid_until(const X509& certificate);

/// Empty, or why `certificate` is not one that `authority` signed, whatever the date.
[[nodiscard]] std::string why_not_signed(X509& certificate, X509& authority);

/// The text of an S/MIME document that `authority` signed, whatever the date. Throws CredentialError.
[[nodiscard]] std::string signed_text(const std::filesystem::path& file, X509& authority);

}  // namespace eti::bus
