#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""House rules that a compiler does not see: who may include whom, where foreign headers stand, licence lines, sizes.

check_layers.py [ROOT]       checks the tree, prints FILE:LINE: MESSAGE for each offence, exits 1 when there is one
check_layers.py --self-test  checks that each rule catches its violation in a scratch tree
"""

import re
import sys
import tempfile
from pathlib import Path

# What a house of the library may include besides itself: other houses, or single headers of them.
MAY_KNOW = {
    "mesh": set(),
    "classify": {"mesh/error.hpp", "mesh/text_file.hpp"},
    "sort": {"mesh"},
    "project": {"mesh"},
    "render": {"mesh", "classify", "sort", "project"},
}
PROGRAMS = ("apps", "tests")  # know everybody
HOUSES = (*MAY_KNOW, *PROGRAMS)
MAX_LINES = 600  # in a file of the library

CPP = {".cpp", ".hpp"}
SHADERS = {".glsl", ".vert", ".frag", ".geom", ".comp"}
SCRIPTS = {".py", ".sh"}

STANDARD_HEADERS = set(
    """algorithm any array atomic barrier bit bitset cassert cctype cerrno cfenv cfloat charconv chrono cinttypes
    climits clocale cmath codecvt compare complex concepts condition_variable coroutine csetjmp csignal cstdarg
    cstddef cstdint cstdio cstdlib cstring ctime cuchar cwchar cwctype deque exception execution filesystem format
    forward_list fstream functional future initializer_list iomanip ios iosfwd iostream istream iterator latch
    limits list locale map memory memory_resource mutex new numbers numeric optional ostream queue random ranges
    ratio regex scoped_allocator semaphore set shared_mutex source_location span sstream stack stdexcept
    stop_token streambuf string string_view strstream syncstream system_error thread tuple type_traits typeindex
    typeinfo unordered_map unordered_set utility valarray variant vector version""".split()
)

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def house_of(path):
    return path.parts[0] if path.parts[0] in HOUSES else None


def resolve(root, file, name):
    """The included file relative to the root, looked for beside the file, then from there; None for a foreign one."""
    for folder in (file.parent, Path()):
        candidate = (root / folder / name).resolve()
        if candidate.is_file() and candidate.is_relative_to(root):
            return candidate.relative_to(root)
    # A header of ours that is generated or missing still belongs to the house it names.
    return Path(name) if "/" in name and house_of(Path(name)) else None


def check_include(root, file, bracket, name):
    """What is wrong with one include, or None."""
    target = resolve(root, file, name)
    if target is None:
        allowed = bracket == "<" and (name in STANDARD_HEADERS or name.startswith("glm/"))
        if allowed or file.suffix == ".cpp" or house_of(file) == "tests":
            return None
        return f"foreign header {name} in a header: include it in a .cpp only"
    house, other = house_of(file), house_of(target)
    if house in PROGRAMS or other is None or other == house:
        return None
    if other in MAY_KNOW[house] or target.as_posix() in MAY_KNOW[house]:
        return None
    return f"{house}/ may not know {target.as_posix()}: it knows {', '.join(sorted(MAY_KNOW[house])) or 'nobody'}"


def check_file(root, file):
    """Yields (line, message) for each offence in one file; `file` is relative to `root`."""
    lines = (root / file).read_text(encoding="utf-8", errors="replace").splitlines()
    licence = "AGPL-3.0-or-later" if file.parts[:2] == ("apps", "mesher") else "BSD-3-Clause"
    comment = "#" if file.suffix in SCRIPTS else "//"
    wanted = f"{comment} SPDX-License-Identifier: {licence}"
    if wanted not in lines[: 1 if file.suffix in CPP else 2]:  # a script's first line may be #!, a shader's #version
        yield 1, f'no licence line "{wanted}"'
    if file.parts[0] in MAY_KNOW and len(lines) > MAX_LINES:
        yield MAX_LINES + 1, f"{len(lines)} lines, more than {MAX_LINES}: split the file"
    if file.suffix in CPP:
        for number, line in enumerate(lines, 1):
            include = INCLUDE.match(line)
            message = include and check_include(root, file, *include.groups())
            if message:
                yield number, message


def source_files(root):
    for house in HOUSES:
        for path in sorted((root / house).rglob("*")):
            if path.is_file() and path.suffix in CPP | SHADERS | SCRIPTS:
                yield path.relative_to(root)


def check_tree(root):
    """(number of files, list of "FILE:LINE: MESSAGE")."""
    root = root.resolve()
    files = list(source_files(root))
    return len(files), [f"{file}:{line}: {message}" for file in files for line, message in check_file(root, file)]


BSD = "// SPDX-License-Identifier: BSD-3-Clause\n"
AGPL = "// SPDX-License-Identifier: AGPL-3.0-or-later\n"

# A tree that keeps every rule, with all that comes close to breaking one.
CLEAN = {
    "mesh/error.hpp": BSD + "#include <string>\n#include <glm/vec3.hpp>\n",
    "mesh/a.hpp": BSD + '#include "mesh/error.hpp"\n#include "error.hpp"\n',
    "mesh/a.cpp": BSD + "#include <vtkCellArray.h>\n#include <unistd.h>\n// #include \"render/a.hpp\"\n",
    "classify/a.hpp": BSD + '#include "mesh/error.hpp"\n',
    "sort/a.hpp": BSD + '#include "mesh/a.hpp"\n',
    "project/a.hpp": BSD + '#include "mesh/a.hpp"\n',
    "render/a.hpp": BSD + "".join(f'#include "{house}/a.hpp"\n' for house in ("mesh", "classify", "sort", "project")),
    "render/gl/a.cpp": BSD + '#include "render/a.hpp"\n#include "gl.h"\n' + "\n" * (MAX_LINES - 3),
    "render/gl/a.frag": "#version 450\n" + BSD,
    "apps/a.hpp": BSD + '#include "render/a.hpp"\n',
    "apps/mesher/a.cpp": AGPL + "#include <tetgen.h>\n" + "\n" * MAX_LINES,
    "apps/a.sh": "#!/bin/sh\n# SPDX-License-Identifier: BSD-3-Clause\n",
    "tests/a.hpp": BSD + '#include <gtest/gtest.h>\n#include "apps/a.hpp"\n',
}

# (file, its text, where the offence must be reported): each breaks one rule.
VIOLATIONS = [
    ("mesh/bad.cpp", BSD + '\n#include "sort/a.hpp"\n', "mesh/bad.cpp:3:"),
    ("mesh/bad.cpp", BSD + '#include "render/not_written_yet.hpp"\n', "mesh/bad.cpp:2:"),
    ("mesh/bad.cpp", BSD + "#  include <classify/a.hpp>\n", "mesh/bad.cpp:2:"),
    ("classify/bad.cpp", BSD + '#include "mesh/a.hpp"\n', "classify/bad.cpp:2:"),
    ("classify/bad.cpp", BSD + '#include "../mesh/a.hpp"\n', "classify/bad.cpp:2:"),
    ("sort/bad.hpp", BSD + '#include "project/a.hpp"\n', "sort/bad.hpp:2:"),
    ("sort/bad.cpp", BSD + '#include "classify/a.hpp"\n', "sort/bad.cpp:2:"),
    ("project/bad.cpp", BSD + '#include "sort/a.hpp"\n', "project/bad.cpp:2:"),
    ("project/bad.cpp", BSD + '#include "render/a.hpp"\n', "project/bad.cpp:2:"),
    ("render/gl/bad.cpp", BSD + '#include "apps/a.hpp"\n', "render/gl/bad.cpp:2:"),
    ("render/bad.cpp", BSD + '#include "tests/a.hpp"\n', "render/bad.cpp:2:"),
    ("mesh/bad.hpp", BSD + "#include <vtkCellArray.h>\n", "mesh/bad.hpp:2:"),
    ("sort/bad.hpp", BSD + "#include <CGAL/Mpzf.h>\n", "sort/bad.hpp:2:"),
    ("project/bad.hpp", BSD + '#include "nlohmann/json.hpp"\n', "project/bad.hpp:2:"),
    ("classify/bad.hpp", BSD + "#include <tbb/parallel_for.h>\n", "classify/bad.hpp:2:"),
    ("render/bad.hpp", BSD + '#include "png.h"\n', "render/bad.hpp:2:"),
    ("render/bad.hpp", BSD + "#include <ImfHeader.h>\n", "render/bad.hpp:2:"),
    ("apps/bad.hpp", BSD + "#include <GL/osmesa.h>\n", "apps/bad.hpp:2:"),
    ("apps/bad.hpp", BSD + "#include <unistd.h>\n", "apps/bad.hpp:2:"),
    ("sort/bad.cpp", "\n" + BSD, "sort/bad.cpp:1:"),
    ("tests/bad.cpp", AGPL, "tests/bad.cpp:1:"),
    ("apps/mesher/bad.cpp", BSD, "apps/mesher/bad.cpp:1:"),
    ("render/gl/bad.frag", "#version 450\n", "render/gl/bad.frag:1:"),
    ("tests/bad.sh", "#!/bin/sh\n", "tests/bad.sh:1:"),
    ("mesh/bad.cpp", BSD + "\n" * MAX_LINES, f"mesh/bad.cpp:{MAX_LINES + 1}:"),
    ("render/bad.hpp", BSD + "\n" * MAX_LINES, f"render/bad.hpp:{MAX_LINES + 1}:"),
]


def write_tree(root, files):
    for name, text in files.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text, encoding="utf-8")


def self_test():
    """Messages about rules that do not do their work."""
    failures = []
    for name, text, place in [(None, None, None), *VIOLATIONS]:
        with tempfile.TemporaryDirectory() as folder:
            write_tree(Path(folder), CLEAN | ({name: text} if name else {}))
            _, offences = check_tree(Path(folder))
        expected = [place] if place else []
        if len(offences) != len(expected) or not all(map(str.startswith, offences, expected)):
            failures.append(f"self-test: expected {expected or 'no offence'}, found {offences}")
    return failures


def main():
    if sys.argv[1:] == ["--self-test"]:
        offences = self_test()
        summary = f"{len(VIOLATIONS)} violations tried"
    else:
        root = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent.parent
        count, offences = check_tree(root)
        if count == 0:
            offences = [f"{root}: no source files here"]
        summary = f"{count} files checked"
    print("\n".join([*offences, f"check_layers: {summary}, {len(offences)} offences"]))
    return 1 if offences else 0


if __name__ == "__main__":
    sys.exit(main())
