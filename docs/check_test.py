#!/usr/bin/env python3
"""Tests of check.py: python3 docs/check_test.py"""

import contextlib
import io
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import check  # noqa: E402


class Repository(unittest.TestCase):
    """A repository of a few pages, and a program `evbench` that repeats its arguments."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name).resolve()
        self.write("configs/a.json", "{}\n")
        self.write("mkdocs.yml", "nav:\n  - page.md\n  - other.md\n")
        self.program = self.write("bin/evbench", "#!/bin/sh\necho \"$@\"\n")
        self.program.chmod(0o755)
        check.anchors_of.cache_clear()
        check.site_pages.cache_clear()

    def write(self, name, text):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        return path

    def faults(self, text, page="docs/page.md"):
        self.write(page, text)
        return [f"{number}: {fault}" for number, fault in sorted(check.page_faults(self.root, page))]

    def failures(self, text, timeout=10.0):
        self.write("docs/page.md", text)
        return check.run_page(self.root, "docs/page.md", self.program, timeout)[1]


class Links(Repository):
    def test_links_to_pages_headings_and_files_are_fine(self):
        self.write("docs/other.md", "# Other page\n\n## What it costs, and why\n\n## Twice\n\n## Twice\n")
        self.assertEqual(self.faults("# Page\n\n[a](other.md) [b](other.md#what-it-costs-and-why) [c](#page)\n"
                                     "[d](other.md#twice-1) [e](../configs/a.json) [f](https://example.org/x#y)\n"), [])

    def test_a_missing_file_is_named_with_its_line(self):
        self.assertEqual(self.faults("# Page\n\n[a](missing.md)\n"), ["3: missing.md: there is no docs/missing.md"])

    def test_a_missing_heading_is_named(self):
        self.write("docs/other.md", "# Other\n")
        self.assertIn("no heading #else", self.faults("[a](other.md#else)\n")[0])

    def test_what_is_code_is_no_link(self):
        self.assertEqual(self.faults("`[a](missing.md)`\n\n```text\n[b](missing.md)\n```\n"), [])

    def test_pictures_and_definitions_are_links(self):
        self.assertEqual(len(self.faults("![a](missing.png)\n\n[b]: missing.md\n\n<img src=\"missing.svg\">\n")), 3)

    def test_links_must_stay_in_the_repository(self):
        self.assertIn("relative", self.faults("[a](/etc/passwd)\n")[0])
        self.assertIn("outside", self.faults("[a](../../)\n")[0])


class Pages(Repository):
    def test_pages_have_a_length_that_can_be_read(self):
        self.assertEqual(self.faults("a\n" * 300), [])
        self.assertIn("301 lines", self.faults("a\n" * 301)[0])
        self.assertIn("121 lines", self.faults("a\n" * 121, "README.md")[0])
        self.write("mkdocs.yml", "- reference/command_line.md\n")
        check.site_pages.cache_clear()
        self.assertEqual(self.faults("a\n" * 500, check.GENERATED[0]), [])

    def test_blocks_of_shell_say_why_they_are_not_run(self):
        self.assertIn("never run", self.faults("```sh\nmake\n```\n")[0])
        self.assertEqual(self.faults("<!-- not run: installs -->\n```sh\nmake\n```\n"), [])
        self.assertEqual(self.faults("<!-- not run: installs -->\n\n```bash\nmake\n```\n"), [])
        self.assertIn("never run", self.faults("<!-- not run: -->\n```sh\nmake\n```\n")[0])

    def test_a_reason_holds_for_one_block(self):
        self.assertEqual(len(self.faults("<!-- not run: long -->\n```sh\na\n```\n\n```sh\nb\n```\n")), 1)

    def test_a_console_block_without_a_command_is_a_fault(self):
        self.assertIn("has no line", self.faults("```console\nmake\n```\n")[0])

    def test_paths_of_files_exist(self):
        self.write("core/data/track.hpp", "")
        self.assertEqual(self.faults("`core/data/track.hpp` `core/data/track.*` `core/data/` `core/NAME.cpp`\n"), [])
        self.assertEqual(self.faults("`core/data/trakc.hpp`\n"), ["1: core/data/trakc.hpp: there is no such file"])

    def test_pages_are_in_the_site(self):
        self.assertIn("nav", self.faults("# Page\n", "docs/guides/else.md")[0])

    def test_lists_need_a_blank_line(self):
        self.assertIn("blank line", self.faults("text:\n- one\n- two\n")[0])
        self.assertEqual(self.faults("text:\n\n- one\n  goes on\n- two\n"), [])


class Commands(Repository):
    def test_output_is_compared(self):
        self.assertEqual(self.failures("```console\n$ evbench a b\na b\n$ echo c\nc\n```\n"), [])
        failure = self.failures("# Page\n\n```console\n$ evbench a b\na c\n```\n")[0]
        self.assertIn("docs/page.md:4: $ evbench a b", failure)
        self.assertIn("- a c", failure)
        self.assertIn("+ a b", failure)

    def test_dots_stand_for_lines_and_for_text(self):
        self.assertEqual(self.failures("```console\n$ seq 20\n1\n...\n7\n...\n20\n```\n"), [])
        self.assertEqual(self.failures("```console\n$ echo took 12.3 s\ntook ... s\n```\n"), [])
        self.assertEqual(self.failures("```console\n$ seq 2\n...\n1\n2\n...\n```\n"), [])
        self.assertTrue(self.failures("```console\n$ seq 3\n1\n...\n4\n```\n"))

    def test_a_failure_shows_what_dots_stood_for(self):
        failure = self.failures("```console\n$ seq 100\n1\n...\n0\n```\n")[0]
        self.assertIn("~ 2\n", failure)
        self.assertIn("~ 100", failure)
        self.assertIn("- 0", failure)
        self.assertNotIn("~ 50", failure)

    def test_progress_of_a_slow_machine_is_no_output(self):
        self.assertEqual(self.failures("```console\n$ echo 'results/a  6 of 9 done'; echo b\nb\n```\n"), [])
        self.assertEqual(self.failures("```console\n$ echo 'a  6 of 9 done'\na  6 of 9 done\n```\n"), [])
        self.assertTrue(self.failures("```console\n$ echo '9 runs, 6 of them failed'\nb\n```\n"))

    def test_a_command_without_output_prints_nothing(self):
        self.assertTrue(self.failures("```console\n$ echo a\n```\n"))
        self.assertEqual(self.failures("```console\n$ true\n\n```\n"), [])

    def test_an_exit_code_is_shown(self):
        self.assertIn("+ [exit 3]", self.failures("```console\n$ (exit 3)\n```\n")[0])
        self.assertEqual(self.failures("```console\n$ echo a; exit 3\na\n[exit 3]\n```\n"), [])
        self.assertTrue(self.failures("```console\n$ true\n[exit 3]\n```\n"))

    def test_blocks_of_a_page_share_folder_variables_and_configs(self):
        self.assertEqual(self.failures("```console\n$ mkdir b && cd b\n$ export A='x y'\n```\n\ntext\n\n"
                                       "```console\n$ echo \"$A\" > c && cat c ../configs/a.json\nx y\n{}\n```\n"), [])

    def test_commands_go_on_in_further_lines(self):
        self.assertEqual(self.failures("```console\n$ evbench a \\\n    b\na b\n```\n"), [])
        self.assertEqual(self.failures("```console\n$ cat <<END\n> a\n> END\na\n```\n"), [])

    def test_the_streams_stand_together(self):
        self.assertEqual(self.failures("```console\n$ echo a; echo b >&2; echo c\na\nb\nc\n```\n"), [])

    def test_a_command_that_takes_too_long_is_ended(self):
        self.assertIn("not done within", self.failures("```console\n$ sleep 30\n```\n", timeout=0.2)[0])

    def test_what_is_not_run_is_not_run(self):
        self.assertEqual(self.failures("<!-- not run: long -->\n```console\n$ false\n```\n"), [])

    def test_the_number_of_failures_is_told(self):
        self.write("docs/page.md", "```console\n$ true\n$ false\n```\n")
        with contextlib.redirect_stdout(io.StringIO()) as output:
            self.assertFalse(check.check_commands(self.root, ["docs/page.md"], self.program, 1, 10.0))
        self.assertIn("1 of 2 commands", output.getvalue())


if __name__ == "__main__":
    unittest.main()
