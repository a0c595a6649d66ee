// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/security/credentials.hpp"

#include <fmt/format.h>
#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/pkcs7.h>
#include <openssl/x509v3.h>

#include <cerrno>
#include <cstring>

#include "common/process/files/file_kind.hpp"

namespace eti::bus {

namespace {

struct FreeBio {
    void operator()(BIO* bio) const { BIO_free_all(bio); }
};
using Bio = std::unique_ptr<BIO, FreeBio>;
struct FreeStore {
    void operator()(X509_STORE* store) const { X509_STORE_free(store); }
};
using Store = std::unique_ptr<X509_STORE, FreeStore>;
struct FreeContext {
    void operator()(X509_STORE_CTX* context) const { X509_STORE_CTX_free(context); }
};
struct FreeSigned {
    void operator()(PKCS7* document) const { PKCS7_free(document); }
};

/// OpenSSL's text of its last error; clears its error queue.
std::string library_reason() {
    const unsigned long code = ERR_peek_last_error();
    const char* reason = ERR_reason_error_string(code);
    ERR_clear_error();
    return reason != nullptr ? reason : "no reason given";
}

Bio open(const std::filesystem::path& file) {
    std::error_code error;
    if (!std::filesystem::exists(file, error)) {
        throw CredentialError(
            fmt::format("{}: is missing; copy the identity's whole folder as make_lab.sh created it, or {}",
                        file.string(), renew_remedy));
    }
    if (const std::string kind = describe_non_regular(file); !kind.empty()) {
        throw CredentialError(fmt::format(
            "{}: is {}, expected a file; copy the identity's whole folder as make_lab.sh created it, or {}",
            file.string(), kind, renew_remedy));
    }
    errno = 0;
    Bio bio(BIO_new_file(file.c_str(), "r"));
    if (!bio) {
        const int reason = errno != 0 ? errno : EIO;
        ERR_clear_error();
        throw CredentialError(fmt::format(
            "{}: cannot be read ({}); give the user of this program read permission, for example with chown",
            file.string(), std::strerror(reason)));
    }
    return bio;
}

/// A store that trusts `authority` alone.
Store store_of(X509& authority) {
    Store store(X509_STORE_new());
    X509_STORE_add_cert(store.get(), &authority);
    // Dates are checked separately, so that an expired file is not reported as forged.
    X509_STORE_set_flags(store.get(), X509_V_FLAG_NO_CHECK_TIME);
    return store;
}

std::time_t seconds_of(const ASN1_TIME* time) {
    std::tm parts{};
    return ASN1_TIME_to_tm(time, &parts) == 1 ? ::timegm(&parts) : 0;
}

}  // namespace

Certificate read_certificate(const std::filesystem::path& file) {
    const Bio bio = open(file);
    Certificate certificate(PEM_read_bio_X509(bio.get(), nullptr, nullptr, nullptr));
    if (!certificate) {
        throw CredentialError(fmt::format("{}: is not a certificate ({}); expected one in PEM; {}",
                                          file.string(), library_reason(), renew_remedy));
    }
    return certificate;
}

Key read_key(const std::filesystem::path& file) {
    const Bio bio = open(file);
    // For an encrypted key OpenSSL would prompt on the terminal.
    const auto no_password = [](char*, int, int, void*) { return -1; };
    Key key(PEM_read_bio_PrivateKey(bio.get(), nullptr, no_password, nullptr));
    if (!key) {
        throw CredentialError(
            fmt::format("{}: is not a private key ({}); expected one in PEM without password; {}",
                        file.string(), library_reason(), renew_remedy));
    }
    return key;
}

std::string subject_of(const X509& certificate) {
    const Bio text(BIO_new(BIO_s_mem()));
    X509_NAME_print_ex(text.get(), X509_get_subject_name(&certificate), 0, XN_FLAG_RFC2253);
    char* bytes = nullptr;
    const long size = BIO_get_mem_data(text.get(), &bytes);
    return {bytes, static_cast<std::size_t>(size)};
}

std::string subject_attribute(const std::string& subject, const std::string& name) {
    const std::string key = "," + name + "=";
    const std::string all = "," + subject;
    const std::size_t at = all.find(key);
    if (at == std::string::npos) {
        return {};
    }
    const std::size_t from = at + key.size();
    return all.substr(from, all.find(',', from) - from);
}

std::time_t valid_from(const X509& certificate) {
    return seconds_of(X509_get0_notBefore(&certificate));
}

std::time_t valid_until(const X509& certificate) {
    return seconds_of(X509_get0_notAfter(&certificate));
}

std::string signature_error(X509& certificate, X509& authority) {
    const Store store = store_of(authority);
    const std::unique_ptr<X509_STORE_CTX, FreeContext> context(X509_STORE_CTX_new());
    X509_STORE_CTX_init(context.get(), store.get(), &certificate, nullptr);
    if (X509_verify_cert(context.get()) == 1) {
        return {};
    }
    ERR_clear_error();
    return X509_verify_cert_error_string(X509_STORE_CTX_get_error(context.get()));
}

std::string read_signed_text(const std::filesystem::path& file, X509& authority) {
    const Bio bio = open(file);
    BIO* content = nullptr;
    const std::unique_ptr<PKCS7, FreeSigned> document(SMIME_read_PKCS7(bio.get(), &content));
    const Bio owned(content);
    if (!document) {
        throw CredentialError(
            fmt::format("{}: is not a signed document, or is truncated ({}); expected S/MIME; {}",
                        file.string(), library_reason(), renew_remedy));
    }
    const Store store = store_of(authority);
    const Bio text(BIO_new(BIO_s_mem()));
    if (PKCS7_verify(document.get(), nullptr, store.get(), content, text.get(), PKCS7_TEXT) != 1) {
        throw CredentialError(fmt::format(
            "{}: its signature is not that of '{}' in permissions_ca.pem ({}): it was modified, or belongs "
            "to another lab; {}",
            file.string(), subject_attribute(subject_of(authority), "CN"), library_reason(), renew_remedy));
    }
    char* bytes = nullptr;
    const long size = BIO_get_mem_data(text.get(), &bytes);
    return {bytes, static_cast<std::size_t>(size)};
}

}  // namespace eti::bus
