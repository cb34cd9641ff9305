#!/bin/bash
# kernel_symbols.sh NAMESPACE OBJECT...: no function of an instruction set's objects may be one that
# the linker could take for everybody: every symbol that others may share is in the set's namespace.
set -euo pipefail
namespace=$1
shift
shared=$(nm --defined-only --format=posix "$@" |
  awk -v own="$namespace" 'NF >= 2 && $2 ~ /^[WwVvu]$/ && index($1, own) == 0 && $1 !~ /^DW\.ref/ { print $1 }')
if [[ -n $shared ]]; then
  echo "Compiled for one instruction set, but shared with the rest of the program:" >&2
  c++filt <<<"$shared" >&2
  exit 1
fi
if [[ $(nm --defined-only --format=posix "$@") != *"$namespace"* ]]; then
  echo "No symbol of $namespace: the check looks at the wrong objects." >&2
  exit 1
fi
