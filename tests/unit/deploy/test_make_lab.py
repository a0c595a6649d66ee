# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Labs made by deploy/security/make_lab.py, read back with openssl; rights of the roles against the topics."""

import io
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "deploy/security"))

import make_lab  # noqa: E402
import roles  # noqa: E402

FILES = {"identity_ca.pem", "permissions_ca.pem", "certificate.pem", "key.pem", "governance.p7s", "permissions.p7s"}


def topics():
    """Names of topics.hpp."""
    return set(re.findall(r"^    X\((\w+), \w+", (ROOT / "common/bus/topics.hpp").read_text(), re.MULTILINE))


class Roles(unittest.TestCase):
    def test_every_topic_has_its_writers(self):
        written = {topic for written in roles.WRITES.values() for topic in written} | set(roles.EVERYBODY)
        self.assertEqual(written, topics())

    def test_only_server_reads_topics_of_other_roles(self):
        self.assertEqual(set(roles.reads("server")), topics())
        for role in set(roles.WRITES) - {"server"}:
            # Role `hands` reads whether a device already holds a tool; poses are best effort, so that no reader blocks
            # them.
            more = set(roles.TOOLS) if role == "hands" else set()
            self.assertEqual(set(roles.reads(role)), set(roles.SERVER) | set(roles.EVERYBODY) | more, role)

    def test_each_role_writes_only_its_topics(self):
        def writers(topic):
            return {role for role, written in roles.WRITES.items() if topic in written}
        self.assertEqual(writers("laryngoscope_pose"), {"laryngoscope", "hands"})
        self.assertEqual(writers("tube_pose"), {"tube", "hands"})
        self.assertEqual(writers("command"), {"trainee", "hands", "instructor"})
        self.assertEqual(writers("session_status"), {"server"})

    def test_security_page_lists_every_role(self):
        page = (ROOT / "docs/security.md").read_text()
        for role, written in roles.WRITES.items():
            row = next((line for line in page.splitlines() if line.startswith(f"| `{role}`")), None)
            self.assertIsNotNone(row, f"docs/security.md has no row for {role}")
            if role != "server":
                self.assertEqual(set(re.findall(r"`(\w+)`", row)) - {role}, set(written), row)


@unittest.skipUnless(shutil.which("openssl"), "openssl is missing; run deploy/setup.sh")
class Lab(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.lab = Path(folder.name, "the lab")

    def make(self, *options, expect=0):
        said = io.StringIO()
        with redirect_stdout(said), redirect_stderr(said):
            try:
                status = make_lab.main(["--out", str(self.lab), *options])
            except SystemExit as end:
                status = end.code
        self.assertEqual(status, expect, said.getvalue())
        return said.getvalue()

    def openssl(self, *arguments):
        done = subprocess.run(["openssl", *map(str, arguments)], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def document(self, name, file):
        return self.openssl("smime", "-verify", "-text", "-in", self.lab / name / file, "-CAfile",
                            self.lab / name / "permissions_ca.pem")

    def test_one_identity_of_each_role_by_default(self):
        self.make()
        self.assertEqual({place.name for place in self.lab.iterdir()}, set(roles.WRITES) | {"authority"})
        for role in roles.WRITES:
            self.assertEqual({file.name for file in (self.lab / role).iterdir()}, FILES)
            self.assertEqual(os.stat(self.lab / role / "key.pem").st_mode & 0o777, 0o600)
            self.openssl("verify", "-CAfile", self.lab / role / "identity_ca.pem", self.lab / role / "certificate.pem")
        self.assertEqual(os.stat(self.lab / "authority").st_mode & 0o777, 0o700)
        for key in ("ca.key", "permissions_ca.key"):
            self.assertEqual(os.stat(self.lab / "authority" / key).st_mode & 0o777, 0o600)

    def test_adding_roles_keeps_existing_identities(self):
        self.make("--role", "server")
        before = {file.name: file.read_bytes() for file in (self.lab / "server").iterdir()}
        authority = (self.lab / "authority/ca.pem").read_bytes()
        self.make("--role", "server", "--role", "observer:observer-2")
        self.assertEqual(before, {file.name: file.read_bytes() for file in (self.lab / "server").iterdir()})
        self.assertEqual((self.lab / "observer-2/identity_ca.pem").read_bytes(), authority)
        subject = self.openssl("x509", "-in", self.lab / "observer-2/certificate.pem", "-noout", "-subject", "-nameopt",
                               "RFC2253")
        self.assertEqual(subject.strip(), "subject=CN=observer-2,OU=observer,O=NeoETI lab")

    def test_renewed_identity_has_a_new_key(self):
        self.make("--role", "tube")
        before = (self.lab / "tube/key.pem").read_bytes()
        self.make("--role", "tube", "--renew", "--days", "5")
        self.assertNotEqual((self.lab / "tube/key.pem").read_bytes(), before)
        self.assertEqual([place.name for place in self.lab.iterdir() if place.name.startswith(".")], [])

    def test_moved_lab_can_be_extended(self):
        self.make("--role", "server")
        moved = self.lab.with_name("moved")
        self.lab.rename(moved)
        self.lab = moved
        self.make("--role", "observer")
        self.openssl("verify", "-CAfile", moved / "server/identity_ca.pem", moved / "observer/certificate.pem")

    def test_permissions_contain_session_domain_and_topics(self):
        self.make("--role", "tube", "--session", "course", "--session", "exam", "--domain", "3-5")
        text = self.document("tube", "permissions.p7s")
        self.assertIn("<subject_name>CN=tube,OU=tube,O=NeoETI lab</subject_name>", text)
        self.assertIn("<id_range><min>3</min><max>5</max></id_range>", text)
        self.assertIn("<default>DENY</default>", text)
        publish = text[text.index("<publish>"):text.index("</publish>")]
        self.assertEqual(re.findall("<topic>(.*?)</topic>", publish),
                         ["eti/tube_pose", "eti/echo_question", "eti/echo_answer"])
        self.assertEqual(re.findall("<partition>(.*?)</partition>", publish), ["course/*", "exam/*"])

    def test_governance_refuses_unauthenticated_participants(self):
        self.make("--role", "server")
        text = self.document("server", "governance.p7s")
        self.assertIn("<allow_unauthenticated_participants>false<", text)
        for kind in ("discovery", "liveliness", "metadata"):
            self.assertIn(f"<{kind}_protection_kind>ENCRYPT<", text)

    def test_certificate_dates_match_request(self):
        self.make("--role", "server", "--from", "2020-01-01", "--days", "30")
        dates = self.openssl("x509", "-in", self.lab / "server/certificate.pem", "-noout", "-dates")
        self.assertIn("notBefore=Jan  1 00:00:00 2020", dates)
        self.assertIn("notAfter=Jan 31 00:00:00 2020", dates)

    def test_invalid_options_are_reported(self):
        for options, status, words in (
            (("--role", "doctor"), 1, "there is no role 'doctor'"),
            (("--role", "tube:../x"), 1, "1 to 48 letters"),
            (("--role", "tube:authority"), 1, "not 'authority'"),
            (("--role", "tube", "--role", "tube"), 1, "two identities with the same name"),
            (("--days", "0"), 2, "1 to 7300"),
            (("--from", "tomorrow"), 2, "expected a date"),
            (("--domain", "233"), 2, "0 to 232"),
            (("--session", "a/b"), 2, "1 to 48 letters"),
        ):
            with self.subTest(options=options):
                self.assertIn(words, self.make(*options, expect=status))
                self.assertFalse(self.lab.exists())

    def test_oversized_permissions_are_refused(self):
        sessions = [part for number in range(60) for part in ("--session", f"course-of-the-year-{number}")]
        self.assertIn("fewer --session", self.make("--role", "observer", *sessions, expect=1))
        self.assertFalse((self.lab / "observer").exists())

    def test_incomplete_authority_is_not_replaced(self):
        self.make("--role", "server")
        (self.lab / "authority/ca.key").unlink()
        self.assertIn("holds ca.pem, permissions_ca.pem, permissions_ca.key alone", self.make("--role", "tube", expect=1))

    def test_lab_with_one_authority_is_not_extended(self):
        self.make("--role", "server")
        for file in ("permissions_ca.pem", "permissions_ca.key"):
            (self.lab / "authority" / file).unlink()
        self.assertIn("can sign permissions. Make a new lab", self.make("--role", "tube", expect=1))

    def test_identity_cannot_sign_permissions(self):
        self.make("--role", "observer")
        own = self.lab / "observer"
        forged = self.lab / "forged.p7s"
        self.openssl("smime", "-sign", "-text", "-in", own / "governance.p7s", "-out", forged, "-signer",
                     own / "certificate.pem", "-inkey", own / "key.pem")
        for authority in ("identity_ca.pem", "permissions_ca.pem"):
            done = subprocess.run(["openssl", "smime", "-verify", "-in", forged, "-CAfile", own / authority],
                                  capture_output=True, text=True)
            self.assertNotEqual(done.returncode, 0, authority)


if __name__ == "__main__":
    unittest.main()
