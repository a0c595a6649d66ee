#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Creates a lab's two authorities and, for each requested role, a folder with an identity for --identity.

One authority says who somebody is, the other one what he may do: with a single one, the key of any identity could sign
permissions. Run again with the same folder, this adds roles to the lab with the same authorities; existing identities are kept unless
--renew is given.
"""

import argparse
import os
import re
import secrets
import shutil
import subprocess
import sys
import tempfile
from datetime import datetime, timedelta, timezone
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import roles  # noqa: E402

ORGANISATION = "NeoETI lab"
AUTHORITY_YEARS = 20
SLACK = timedelta(days=1)  # allowance for differing clocks and time zones
LARGEST_PERMISSIONS = 5000  # [bytes] of the 8192 in common/bus/transport.hpp, beside certificate and keys
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,47}")

CONFIGURATION = """
[ca]
default_ca = lab
[lab]
database = {folder}/issued.txt
new_certs_dir = {folder}/issued
rand_serial = yes
unique_subject = no
default_md = sha256
policy = policy
preserve = yes
[policy]
organizationName = supplied
organizationalUnitName = optional
commonName = supplied
[authority]
basicConstraints = critical,CA:TRUE,pathlen:0
keyUsage = critical,keyCertSign,cRLSign,digitalSignature
subjectKeyIdentifier = hash
[identity]
basicConstraints = critical,CA:FALSE
keyUsage = critical,digitalSignature,keyAgreement
extendedKeyUsage = critical,clientAuth,serverAuth
subjectKeyIdentifier = hash
authorityKeyIdentifier = keyid
[req]
distinguished_name = name
[name]
"""


class LabError(Exception):
    """A problem that the user can fix."""


def openssl(*arguments):
    done = subprocess.run(["openssl", *map(str, arguments)], stdin=subprocess.DEVNULL, capture_output=True, text=True)
    if done.returncode != 0:
        raise LabError(f"openssl {arguments[0]} failed: {done.stderr.strip() or 'without a word'}")
    return done.stdout


def make_key(file):
    """A private key that only its owner can read at any time."""
    with os.fdopen(os.open(file, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), "w") as out:
        out.write(openssl("genpkey", "-algorithm", "EC", "-pkeyopt", "ec_paramgen_curve:P-256"))


class Authority:
    """A certificate and the key that signs with it."""

    def __init__(self, folder, name):
        self.certificate = folder / f"{name}.pem"
        self.key = folder / f"{name}.key"

    def files(self):
        return [file for file in (self.certificate, self.key) if file.exists()]


class Lab:
    def __init__(self, folder):
        self.folder = Path(folder)
        self.own = self.folder / "authority"  # keep it separate: its owner can create any identity
        self.identities = Authority(self.own, "ca")
        self.permissions = Authority(self.own, "permissions_ca")
        self.configuration = self.own / "openssl.cnf"

    def make_authorities(self, valid_from):
        """Creates the lab's authorities if they do not exist; returns whether they are new."""
        there = self.identities.files() + self.permissions.files()
        if len(there) == 4:
            return False
        if there == [self.identities.certificate, self.identities.key]:
            raise LabError(f"{self.own} was made with one authority for identities and permissions: whoever has an "
                           "identity of this lab can sign permissions. Make a new lab in another --out, and give its "
                           "folders to every machine")
        if there:
            raise LabError(f"{self.own} holds {', '.join(file.name for file in there)} alone; expected ca.pem, ca.key, "
                           "permissions_ca.pem and permissions_ca.key. Restore the others from where the authorities are "
                           "kept, or choose another --out for a new lab")
        self.own.mkdir(parents=True, exist_ok=True, mode=0o700)
        (self.own / "issued").mkdir(exist_ok=True)
        (self.own / "issued.txt").touch()
        begin = min(valid_from, datetime.now(timezone.utc)) - SLACK
        # The authorities' name identifies the lab.
        name = f"{ORGANISATION} {secrets.token_hex(4)}"
        for authority, common_name in ((self.identities, name), (self.permissions, f"{name} permissions")):
            make_key(authority.key)
            self.issue(authority, authority.key, f"/O={ORGANISATION}/CN={common_name}", begin,
                       begin + timedelta(days=365 * AUTHORITY_YEARS), authority.certificate, "authority")
        return True

    def issue(self, authority, key, subject, begin, end, file, extensions):
        self.configuration.write_text(CONFIGURATION.format(folder=self.own.absolute()))  # the lab may have been moved
        signer = ["-selfsign"] if extensions == "authority" else ["-cert", authority.certificate]
        with tempfile.TemporaryDirectory() as scratch:
            request = Path(scratch, "request.pem")
            openssl("req", "-new", "-config", self.configuration, "-key", key, "-subj", subject, "-out", request)
            openssl("ca", "-batch", "-notext", "-config", self.configuration, "-extensions", extensions, *signer,
                    "-keyfile", authority.key, "-startdate", f"{begin:%Y%m%d%H%M%SZ}", "-enddate",
                    f"{end:%Y%m%d%H%M%SZ}", "-in", request, "-out", file)

    def sign(self, text, file):
        """Writes `text` as S/MIME with the signature of the permissions' authority."""
        with tempfile.NamedTemporaryFile("w", suffix=".xml") as document:
            document.write(text)
            document.flush()
            openssl("smime", "-sign", "-text", "-md", "sha256", "-in", document.name, "-out", file, "-signer",
                    self.permissions.certificate, "-inkey", self.permissions.key)

    def make_identity(self, role, name, begin, end, sessions, domains):
        """Creates DIR/NAME, complete or not at all."""
        place = self.folder / name
        with tempfile.TemporaryDirectory(dir=self.folder, prefix=f".{name}-") as scratch:
            made = Path(scratch, name)
            made.mkdir(mode=0o700)
            make_key(made / "key.pem")
            self.issue(self.identities, made / "key.pem", f"/O={ORGANISATION}/OU={role}/CN={name}", begin, end,
                       made / "certificate.pem", "identity")
            shutil.copyfile(self.identities.certificate, made / "identity_ca.pem")
            shutil.copyfile(self.permissions.certificate, made / "permissions_ca.pem")
            self.sign(roles.governance(self.authority_name()), made / "governance.p7s")
            subject = self.subject(made / "certificate.pem")
            # The certificate's own dates are decisive; those of permissions are read as local time.
            text = roles.permissions(role, name, subject, begin - SLACK, end + SLACK, sessions, domains)
            self.sign(text, made / "permissions.p7s")
            size = (made / "permissions.p7s").stat().st_size
            if size > LARGEST_PERMISSIONS:
                raise LabError(f"{name}: permissions of {size} bytes, at most {LARGEST_PERMISSIONS} fit the datagram in "
                               "which programs show them; give fewer --session, or none for all")
            if place.exists():
                place.rename(Path(scratch, "old"))
            made.rename(place)

    @staticmethod
    def subject(certificate):
        line = openssl("x509", "-in", certificate, "-noout", "-subject", "-nameopt", "RFC2253")
        return line.strip().removeprefix("subject=")

    def authority_name(self):
        return self.subject(self.identities.certificate).split(",")[0].removeprefix("CN=")


def role_and_name(text):
    role, _, name = text.partition(":")
    name = name or role
    if role not in roles.WRITES:
        raise LabError(f"--role {text}: there is no role '{role}'; expected one of {', '.join(roles.WRITES)}")
    if not NAME.fullmatch(name) or name == "authority":
        raise LabError(f"--role {text}: the name '{name}' names a folder and a certificate; expected 1 to 48 letters, "
                       "digits, '.', '-' or '_', and not 'authority'")
    return role, name


def day(text):
    try:
        return datetime.strptime(text, "%Y-%m-%d").replace(tzinfo=timezone.utc)
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}': expected a date such as 2025-01-31") from None


def domain_range(text):
    first, _, last = text.partition("-")
    if not first.isdigit() or not (last or first).isdigit() or not int(first) <= int(last or first) <= 232:
        raise argparse.ArgumentTypeError(f"'{text}': expected a domain from 0 to 232, or a range such as 0-9")
    return int(first), int(last or first)


def positive(text):
    if not text.isdigit() or not 1 <= int(text) <= 7300:
        raise argparse.ArgumentTypeError(f"'{text}': expected 1 to 7300 days")
    return int(text)


def parse(arguments):
    parser = argparse.ArgumentParser(
        prog="make_lab.sh", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="roles:\n" + "\n".join(f"  {role:<14}{text}" for role, text in roles.DOES.items()))
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="the lab's folder")
    parser.add_argument("--role", action="append", default=[], metavar="ROLE[:NAME]",
                        help="an identity in DIR/NAME; may be repeated; by default one of each role")
    parser.add_argument("--days", type=positive, default=365, metavar="N", help="validity of the identities (365)")
    parser.add_argument("--from", type=day, dest="begin", metavar="DATE", help="first day of validity (yesterday)")
    parser.add_argument("--session", action="append", default=[], metavar="NAME",
                        help="a session they may join; may be repeated; by default all")
    parser.add_argument("--domain", type=domain_range, default=(0, 232), metavar="N[-N]",
                        help="domains that they may join (0-232)")
    parser.add_argument("--renew", action="store_true", help="replace existing identities, with new keys")
    options = parser.parse_args(arguments)
    for session in options.session:
        if not NAME.fullmatch(session):
            parser.error(f"--session {session}: expected 1 to 48 letters, digits, '.', '-' or '_'")
    return options


def main(arguments=None):
    options = parse(arguments)
    try:
        wanted = [role_and_name(text) for text in options.role or roles.WRITES]
        if len({name for _, name in wanted}) < len(wanted):
            raise LabError("--role: two identities with the same name; name each, as in --role observer:observer-2")
        begin = options.begin or datetime.now(timezone.utc) - SLACK
        lab = Lab(options.out)
        new = lab.make_authorities(begin)
        print(f"{'New' if new else 'Known'} authorities '{lab.authority_name()}' in {lab.own}: keep this folder in a safe place and " 
              "secret; no program needs it.")
        for role, name in wanted:
            place = lab.folder / name
            if place.exists() and not options.renew:
                print(f"{place}: kept (--renew replaces it)")
                continue
            lab.make_identity(role, name, begin, begin + timedelta(days=options.days), options.session, options.domain)
            print(f"{place}: {role}, valid until {begin + timedelta(days=options.days):%Y-%m-%d}")
    except (LabError, OSError) as error:
        print(f"make_lab: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
