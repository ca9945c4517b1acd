"""A full disk ends the run with status 4 and one message that names the file; earlier frames stay readable.

The disk is a file system of 3 MB in memory: mounted by root, or by a user in a namespace of his own. Where the system
allows neither, the test is skipped (status 77).
"""

import os
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import support  # noqa: E402

MOUNT = ["mount", "-t", "tmpfs", "-o", "size=3m,mode=0777", "tmpfs"]


class FullDisk(support.SceneTest):
    def setUp(self):
        super().setUp()
        self.out.mkdir()
        subprocess.run([*MOUNT, str(self.out)], check=True)
        self.addCleanup(subprocess.run, ["umount", str(self.out)], check=True)

    def test_full_disk(self):
        for arguments in (("--layout", "separate", "--fluid-ranks", "2"), ("--layout", "shared", "--fluid-ranks", "2")):
            with self.subTest(layout=arguments[1]):
                outcome = self.run_scene(*arguments, "--end-time", "1000")
                self.assert_refused(outcome, 4, str(self.out), "space|disk", within=120)
                self.assert_output_readable()
                for path in sorted(self.out.rglob("*"), reverse=True):
                    path.unlink() if path.is_file() or path.is_symlink() else path.rmdir()


def can_mount(folder):
    if subprocess.run([*MOUNT, str(folder)], stderr=subprocess.DEVNULL).returncode != 0:
        return False
    subprocess.run(["umount", str(folder)], check=True)
    return True


if __name__ == "__main__":
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        mountable = can_mount(folder)
    if not mountable and os.geteuid() != 0 and "EMBACLE_IN_NAMESPACE" not in os.environ:
        os.environ["EMBACLE_IN_NAMESPACE"] = "1"
        status = subprocess.run(["unshare", "-rm", sys.executable, *sys.argv]).returncode
        sys.exit(status)
    if not mountable:
        print("no file system can be mounted here: skipped")
        sys.exit(77)
    support.main()
