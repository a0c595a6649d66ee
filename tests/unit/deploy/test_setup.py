# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""deploy/setup.sh with a PATH whose apt-get only records its calls."""

import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
TOOLS = ("bash", "sed", "awk", "grep", "dirname", "basename", "id", "env", "cat", "mkdir")


class Setup(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.root = Path(self.folder.name, "a folder")
        self.setup = self.root / "deploy" / "setup.sh"
        shutil.copytree(ROOT / "deploy/packages", self.root / "deploy/packages")
        for name in ("setup.sh", "progress.sh"):
            shutil.copy(ROOT / "deploy" / name, self.root / "deploy")
        self.bin = Path(self.folder.name, "bin")
        self.bin.mkdir()
        self.calls = self.bin / "calls"
        self.calls.touch()
        for tool in TOOLS:
            (self.bin / tool).symlink_to(shutil.which(tool))
        self.wanted = self.run_setup("--list").stdout.split()

    def run_setup(self, *arguments, release="bookworm", **environment):
        return subprocess.run(["bash", self.setup, *arguments], capture_output=True, text=True,
                              env={"PATH": str(self.bin), "ETI_OS_RELEASE": str(self.os_release(release)), **environment})

    def os_release(self, codename):
        file = Path(self.folder.name, codename)
        file.write_text(f'PRETTY_NAME="A system named {codename}"\nVERSION_CODENAME={codename}\n')
        return file

    def program(self, name, body):
        file = self.bin / name
        file.unlink(missing_ok=True)
        file.write_text(f"#!{shutil.which('bash')}\n{body}\n")
        file.chmod(0o755)

    def apt(self, installed, body="exit 0"):
        """An apt with `installed` as installed packages, and whose apt-get runs `body`."""
        self.program("dpkg-query", "".join(f"echo 'installed {p}'\n" for p in installed))
        self.program("dpkg", "exit 0")
        self.program("sudo", '"$@"')
        self.program("apt-get", f'echo "$*" >> {self.calls}\n{body}')

    def test_lists_name_packages_once(self):
        self.assertGreater(len(self.wanted), 20)
        self.assertEqual(len(self.wanted), len(set(self.wanted)))
        for name in self.wanted:
            self.assertRegex(name, r"^[a-z0-9][a-z0-9+.-]+$")

    def test_each_release_has_its_own_names(self):
        names = {release: set(self.run_setup("--list", release=release).stdout.split())
                 for release in ("bookworm", "trixie")}
        self.assertEqual(names["bookworm"] - names["trixie"], {"libfastrtps-dev", "libddsc0debian"})
        self.assertEqual(names["trixie"] - names["bookworm"], {"libfastdds-dev", "libddsc0t64"})

    def test_other_release_is_refused_with_remedy(self):
        self.apt([])
        done = self.run_setup(release="noble")
        self.assertEqual(done.returncode, 1)
        for part in ("A system named noble", "Debian 12 (bookworm)", "Debian 13 (trixie)", "ETI_RELEASE=trixie"):
            self.assertIn(part, done.stderr)
        self.assertEqual(self.calls.read_text(), "", "nothing is installed")

    def test_names_of_a_release_can_be_requested(self):
        asked = self.run_setup("--list", release="noble", ETI_RELEASE="trixie").stdout
        self.assertEqual(asked, self.run_setup("--list", release="trixie").stdout)

    def test_server_list_has_no_graphics(self):
        server = (ROOT / "deploy/packages/build.txt").read_text()
        for word in ("epoxy", "egl", "mesa", "glfw", "imgui", "opencv"):
            self.assertNotIn(word, server)

    def test_complete_installation_does_not_call_apt(self):
        self.apt(self.wanted)
        done = self.run_setup()
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.calls.read_text(), "")

    def test_missing_packages_are_listed_then_installed(self):
        missing = [self.wanted[0], self.wanted[-1]]
        self.apt([p for p in self.wanted if p not in missing], 'echo "apt-get is running" >&2')
        done = self.run_setup()
        self.assertEqual(done.returncode, 0, done.stderr)
        said_before = done.stderr.split("apt-get is running")[0]
        self.assertIn("To be installed with apt-get: " + " ".join(missing), said_before)
        update, install = self.calls.read_text().splitlines()
        self.assertIn("update", update)
        self.assertTrue(install.endswith(" ".join(missing)), install)

    def test_without_apt_lists_packages_and_exits(self):
        done = self.run_setup()
        self.assertEqual(done.returncode, 3)
        self.assertIn("no apt", done.stderr)
        self.assertLessEqual(set(self.run_setup("--list", release="trixie").stdout.split()), set(done.stderr.split()))

    def test_unreachable_mirror_is_reported(self):
        self.apt(self.wanted[1:], "echo 'Could not resolve host' >&2; exit 100")
        done = self.run_setup()
        self.assertEqual(done.returncode, 1)
        self.assertIn("apt-get update failed", done.stderr)
        self.assertIn("Check the network", done.stderr)

    def test_cached_lists_are_used_if_update_fails(self):
        self.apt(self.wanted[1:], '[[ "$*" == *update* ]] && exit 100 || exit 0')
        done = self.run_setup()
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("apt-get update failed", done.stderr)

    def test_failed_install_is_reported(self):
        self.apt(self.wanted[1:], '[[ "$*" == *install* ]] && exit 100 || exit 0')
        done = self.run_setup()
        self.assertEqual(done.returncode, 1)
        self.assertIn("apt-get install failed", done.stderr)
        self.assertNotIn("Check the network", done.stderr)

    def test_uses_sudo_without_root(self):
        self.apt(self.wanted[1:])
        self.program("id", "echo 1000")
        self.program("sudo", f'echo sudo >> {self.calls}; "$@"')
        done = self.run_setup()
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.calls.read_text().splitlines().count("sudo"), 3)

    def test_interrupted_installation_is_completed(self):
        self.apt(self.wanted[1:])
        self.program("dpkg", f'echo "dpkg $*" >> {self.calls}')
        self.assertEqual(self.run_setup().returncode, 0)
        self.assertEqual([line.split()[0] for line in self.calls.read_text().splitlines()], ["-q", "dpkg", "-q"])

    def test_npm_of_old_node_is_refused(self):
        without_npm = [p for p in self.wanted if p != "npm"]
        for version, asked in (("v12.22.9", True), ("v18.19.0", False), ("", True)):
            with self.subTest(node=version):
                self.calls.write_text("")
                self.apt(without_npm)
                self.program("npm", "echo 9.2.0")
                self.program("node", f"echo {version}")
                self.run_setup()
                self.assertEqual("npm" in self.calls.read_text().split(), asked)

    def test_progress_counts_downloads_unpacking_and_setup(self):
        self.apt(self.wanted[1:], """[[ "$*" == *install* ]] || exit 0
echo '0 upgraded, 2 newly installed, 0 to remove and 3 not upgraded.'
echo 'Need to get 5,000 kB of archives.'
echo 'Get:1 http://mirror b 1.0'
for step in Unpacking 'Setting up'; do for package in a b; do echo "$step $package (1.0) ..."; done; done""")
        done = self.run_setup()
        self.assertIn("Need to get 5,000 kB", done.stderr)
        self.assertRegex(done.stderr, r"Installing: 6 of 6, \d+ s so far")
        self.assertNotIn("Unpacking a", done.stderr)
        self.assertIn("Unpacking a", (self.root / "build/logs/apt-install.log").read_text())

    def test_without_root_and_sudo_prints_command(self):
        self.apt(self.wanted[1:])
        self.program("id", "echo 1000")
        (self.bin / "sudo").unlink()
        done = self.run_setup()
        self.assertEqual(done.returncode, 1)
        self.assertIn("As root run: apt-get install " + self.wanted[0], done.stderr)
        self.assertEqual(self.calls.read_text(), "")


if __name__ == "__main__":
    unittest.main()
