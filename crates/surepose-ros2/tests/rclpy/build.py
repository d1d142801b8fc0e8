"""Runs the interface builder: `build.py BUILDER PACKAGE FILE --out DIR`.

The builder puts _ before every capital of a name; ROS, whose files it looks for, makes tf_message of TFMessage.
"""

import importlib.util
import re
import sys
import types


def words(_pattern, _separator, name):
    name = re.sub(r"(.)([A-Z][a-z]+)", r"\1_\2", name)
    return re.sub(r"([a-z0-9])([A-Z])", r"\1_\2", name)


def main():
    builder = sys.argv.pop(1)
    spec = importlib.util.spec_from_file_location("builder", builder)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    module.re = types.SimpleNamespace(sub=words, findall=re.findall, M=re.M)
    module.main()


if __name__ == "__main__":
    main()
