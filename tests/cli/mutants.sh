#!/bin/sh
# mutants.sh - each wrong cell kernel of tests/cell_kernel.mutants fails the stress test, the right one passes.
exec scripts/run-mutants
