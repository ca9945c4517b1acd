#!/bin/sh
# What liggghts-mps and the preloaded liggghts answer to right and wrong scripts: exit status, message, and that the
# other program ends as well. Usage: exit_status.sh MPIEXEC LIGGGHTS_MPS WAITING_FLUID PRELOAD_LIBRARY [LIGGGHTS]
mpiexec="$1 --oversubscribe --mca mpi_yield_when_idle 1 --mca btl_vader_single_copy_mechanism none"
solid=$2 fluid=$3 preload=$4 liggghts=${5:-liggghts}
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
failures=0

# check NAME STATUS TEXT COMMAND...: the command must end within 10 s with STATUS and print TEXT exactly once. (An error
# that both programs meet may be printed by both, each under its name.)
check() {
  name=$1 status=$2 text=$3
  shift 3
  start=$(date +%s)
  timeout 60 "$@" > output 2>&1
  got=$?
  seconds=$(($(date +%s) - start))
  count=$(grep -c -- "$text" output)
  if [ "$got" -ne "$status" ] || [ "$count" -lt 1 ] || [ "$count" -gt "${most:-1}" ] || [ "$seconds" -gt 10 ]; then
    echo "FAILED: $name: status $got (expected $status), text found $count times, $seconds s"
    cat output
    failures=$((failures + 1))
  else
    echo "ok: $name ($seconds s)"
  fi
}

cat > head <<'END'
units si
atom_style granular
atom_modify map array
boundary f f f
newton off
communicate single vel yes
region box block -1 1 -1 1 -1 1 units box
create_box 1 box
neighbor 0.01 bin
neigh_modify delay 0 every 1 check yes
fix m1 all property/global youngsModulus peratomtype 5e7
fix m2 all property/global poissonsRatio peratomtype 0.3
fix m3 all property/global coefficientRestitution peratomtypepair 1 0.5
fix m4 all property/global coefficientFriction peratomtypepair 1 0.4
pair_style gran model hertz tangential history
pair_coeff * *
timestep 1e-5
fix gravity all gravity 9.81 vector 0 0 -1
fix motion all multisphere
END
blocks="fix floes all floe/create shape box 0.2 0.2 0.1 density 900 spacing 0.1"
{ cat head; echo "$blocks position 0 0 0"; echo "run 10"; } > in.alone
{ cat head; echo "$blocks position 0 0 0"; echo "fix couple all couple/mps"; } > in.coupled
{ cat head; echo "$blocks position 0 0 0"; echo "pair_stile gran"; echo "fix couple all couple/mps"; } > in.wrong
{ cat head; echo "$blocks position 0 0 0 position 0.1 0 0"; echo "fix couple all couple/mps"; } > in.overlap
{ cat head; echo "$blocks position 0.95 0 0"; echo "fix couple all couple/mps"; } > in.outside
{ cat head; echo "$blocks positoin 0 0 0"; echo "fix couple all couple/mps"; } > in.keyword
{ cat head; echo "$blocks position 0 0 0"; echo "fix couple all couple/mps"; echo "quit"; } > in.quit
{ sed 's/delay 0/delay 10/' head; echo "$blocks position 0 0 0"; echo "fix couple all couple/mps"; } > in.delay
{ sed '/gravity/d' head; echo "$blocks position 0 0 0"; echo "fix couple all couple/mps"; } > in.weightless

quiet="-screen none -log none"
pair="$mpiexec -n 1 $fluid 30 : -n 2 $solid $quiet -in"
check "coupled run" 0 "the water ran 30 windows" $pair in.coupled
check "summary" 0 "the water ran 30 windows" $pair in.coupled -var out .
check "summary's content" 0 '"windows": 30,$' cat solid-summary.json
check "wrong command" 2 "in.wrong: Unknown command" $pair in.wrong
check "its line" 2 "in the line: pair_stile gran" $pair in.wrong
check "overlapping bodies" 2 "the deepest overlap is 0.1 m" $pair in.overlap
check "body outside" 2 "in.outside: fix floes floe/create: body 1 .* reaches from x = 0.85 to 1.05 m" $pair in.outside
check "wrong keyword" 2 "did you mean 'position'" $pair in.keyword
check "quit in a coupled script" 2 "quit ends the script" $pair in.quit
check "neighbour delay" 2 "needs 'neigh_modify delay 0 every 1 check yes'" $pair in.delay
most=2
check "gravity differs" 2 "error: .*gravity differs" $pair in.weightless
most=1
check "no coupling beside a fluid" 2 "contains no 'fix ID all couple/mps'" $pair in.alone
check "missing script" 2 "in.missing: .*annot open input script in.missing" $pair in.missing
check "no script" 2 "give the LIGGGHTS script with -in" $mpiexec -n 1 $fluid : -n 1 $solid $quiet
check "alone" 0 "Loop time of" $mpiexec -n 2 $solid -log none -in in.alone
check "alone, but coupled script" 2 "no fluid runs beside it" $mpiexec -n 2 $solid $quiet -in in.coupled
check "alone, wrong script" 2 "in.outside: .*reaches from" $mpiexec -n 2 $solid $quiet -in in.outside
check "help" 0 "Exit status: 0 done" $solid --help
check "version" 0 "liggghts-mps [0-9]" $solid --version

# The stock program with the styles preloaded.
stock="$mpiexec -n 2 -x LD_PRELOAD=$preload $liggghts -log none"
check "preloaded" 0 "Loop time of" $stock -in in.alone
check "preloaded, body outside" 2 "reaches from x = 0.85 to 1.05 m" $stock -in in.outside
check "preloaded, coupled script" 2 "run it with liggghts-mps" $stock -in in.coupled

[ "$failures" -eq 0 ]
