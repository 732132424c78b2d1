# leafcast - out-of-core volume ray tracing. `make list` says what can be made.
#
# Sources are found by wildcard: every .c file of the four layers goes into app/libinternal.a, with which
# verbs and tests are linked, except X_main.c, which is the verb X (build/release/libexec/leafcast-X), and
# what verbs share: render/app and render/bench have archives of their own. A new source needs no line
# here. The library for others, lib/libleafcast.a and .so, is what render/door/leafcast*.c and prep/leafcast*.c
# need of that.

VERSION := $(shell sed -n 's/^.define LEAFCAST_VERSION "\(.*\)"/\1/p' render/leafcast.h)
CONFIG  ?= release
PREFIX  ?= /usr/local
DESTDIR ?=
WERROR  ?= 0
OBJCOPY ?= objcopy
TIMEOUT ?= 300

# ---- compilers and flags -------------------------------------------------------------------------
ifeq ($(CONFIG)-$(origin CC),fuzz-default)
CC := clang
endif
# CROSS=aarch64-linux-gnu: a build for another machine, by the compiler and with the libraries that Debian
# calls so. RUNNER, an emulator, begins its programs in tests.
CROSS  ?=
RUNNER ?= $(if $(CROSS),qemu-$(firstword $(subst -, ,$(CROSS)))-static)
ifneq ($(CROSS),)
ifeq ($(origin CC),default)
CC := $(CROSS)-gcc
endif
AR := $(CROSS)-ar
LD := $(CROSS)-ld
OBJCOPY := $(CROSS)-objcopy
endif
PKG_CONFIG := $(if $(CROSS),PKG_CONFIG_LIBDIR=/usr/lib/$(CROSS)/pkgconfig )pkg-config
CLANG := $(findstring clang,$(notdir $(firstword $(CC))))
ifeq ($(origin CXX),default)
CXX := $(if $(CLANG),clang++,g++)
endif
B := build/$(CONFIG)$(if $(CLANG),$(if $(filter fuzz,$(CONFIG)),,-clang))$(addprefix -,$(CROSS))

# With sanitizers, compilers take long: at -O1, with lines but without variables, two thirds of what -O2 -g takes.
SAFE           := -O1 -g1 -fno-omit-frame-pointer -fno-sanitize-recover=all
FLAGS_release  := -O3 -DNDEBUG
FLAGS_debug    := -Og -g3 -fno-omit-frame-pointer
# A quarter of the time of what runs goes without these three: a null pointer and the end of an object are the other
# sanitizer's, too; fuzz has all.
FLAGS_sanitize := $(SAFE) -fsanitize=address,undefined -fno-sanitize=null,object-size,pointer-overflow
FLAGS_thread   := $(SAFE) -fsanitize=thread
FLAGS_coverage := -O0 -g --coverage
FLAGS_fuzz     := $(SAFE) -fsanitize=fuzzer-no-link,address,undefined
CONFIGS        := release debug sanitize thread coverage fuzz
ifeq ($(filter $(CONFIG),$(CONFIGS)),)
$(error CONFIG=$(CONFIG) is not one of: $(CONFIGS))
endif

# Results must not depend on the compiler: no contraction to FMA, never -ffast-math, no -march.
# One set of objects for programs and the shared library: -fPIC costs no instruction in hot functions.
MACHINE := $(shell $(CC) -dumpmachine 2>/dev/null)
X86     := $(filter x86_64% i%86%,$(MACHINE))
# gcc 12.2 dies of loops of fmin() and fmax() there (in vect_transform_reduction).
NO_LOOPS := $(if $(CLANG),,$(if $(filter aarch64%,$(MACHINE)),-fno-tree-loop-vectorize))
COMMON := $(FLAGS_$(CONFIG)) $(NO_LOOPS) -fPIC -fvisibility=hidden -ffp-contract=off -fno-math-errno -pthread -I. -Iformats -Irender \
          -DLEAFCAST_VERSION='"$(VERSION)"'
WARN   := -Wall -Wextra -Wshadow -Wvla -Wpointer-arith -Wwrite-strings -Wundef \
          $(if $(filter 1,$(WERROR)),-Werror)
WARN_C := -Wconversion -Wno-sign-conversion -Wstrict-prototypes -Wmissing-prototypes -Wold-style-definition
# Stacks may be small (formats/base/thread.h); other builds have larger frames.
FRAMES := $(if $(filter release,$(CONFIG)),$(if $(CLANG),,-Wframe-larger-than=32768))
ALL_C   = -std=c17 -D_GNU_SOURCE $(COMMON) $(WARN) $(WARN_C) $(DEPS_CFLAGS) $(CPPFLAGS) $(CFLAGS)
# The helpers in C++ go without sanitizers: OpenImageIO and TetGen are not built for them.
ALL_CXX = -std=c++17 -D_GNU_SOURCE $(filter-out -fsanitize=%,$(COMMON)) $(WARN) \
          $(CPPFLAGS) $(CXXFLAGS)
ALL_LIBS = $(DEPS_LIBS) $(DOOR_LIBS)
# What UBSan says has half a million addresses, which programs that may lie anywhere set whenever they begin.
PLACE    := $(if $(filter sanitize,$(CONFIG)),-no-pie)

# ---- what there is -------------------------------------------------------------------------------
SOURCES  := $(sort $(wildcard $(foreach d,formats prep stream render,$d/*.c $d/*/*.c)))
SOURCES  := $(if $(X86),$(SOURCES),$(filter-out %_sse42.c %_avx2.c %_avx512.c,$(SOURCES)))
MAINS    := $(filter %_main.c,$(SOURCES))
TETGEN_C := prep/tetrahedralize/tetrahedralize_main.c
NATIVE   := render/bench/peer_embree.c render/bench/peer_rays.c
# In the place of the C library's functions, in importers alone. Sanitizers have an allocator of their own and look
# into their process, coverage writes what it counted: their importers announce files, but have no fence.
IN_PLACE := prep/import/import_calls.c prep/import/import_malloc.c
WATCHED  := $(filter sanitize thread fuzz coverage,$(CONFIG))
IN_PLACE_O := $(patsubst %.c,$B/obj/%.o,$(if $(WATCHED),prep/import/import_calls.c,$(IN_PLACE)))
PARTS    := $(filter-out $(MAINS) $(NATIVE) $(IN_PLACE),$(SOURCES))
# The verb view is the folder render/view. What of it needs no library goes into the archive of verbs.
VIEW_C   := render/view/view_main.c
VIEW_PURE := render/view/view_state.c render/view/view_slice_state.c render/view/view_access.c \
             render/view/view_crowd.c render/view/view_pace.c render/view/view_stride.c \
             render/view/view_where.c render/view/view_scene.c render/view/view_changes.c \
             render/view/view_cast.c
PAGE     := $(sort $(wildcard render/view/page/*))
VIEW     := $B/app/libview.a
INTERNAL := $B/app/libinternal.a
APP      := $B/app/libapp.a
BENCH    := $B/app/libbench.a
ARCHIVES := $(BENCH) $(APP) $(INTERNAL)
DOOR     := $(patsubst %.c,$B/obj/%.o,$(filter formats/public_status.c prep/leafcast% render/door/leafcast%,$(PARTS)))
HEADERS  := $(wildcard render/leafcast.h render/leafcast_dynamic.h render/leafcast_look.h render/leafcast_experimental.h prep/leafcast_prep.h formats/leafcast_grid.h formats/leafcast_status.h)
STATIC   := $B/lib/libleafcast.a
SONAME   := libleafcast.so.$(firstword $(subst ., ,$(VERSION)))
SHARED   := $B/lib/libleafcast.so.$(VERSION)
# A verb import-X is the folder prep/import/X, linked with the library that it is for.
IMPORTS   = $(patsubst prep/import/%/,%,$(wildcard prep/import/*/))
IMPORTERS = $(foreach x,$(IMPORTS),$(if $(LIB_$x),$B/libexec/leafcast-import-$x))
VERBS_C   = $(filter-out $(if $(TETGEN),,$(TETGEN_C)) $(if $(LIB_view),,$(VIEW_C)),$(MAINS))
verb      = $B/libexec/leafcast-$(subst _,-,$(patsubst %_main.c,%,$(notdir $1)))
VERBS     = $(foreach m,$(VERBS_C),$(call verb,$m))
FRONT    := $B/bin/leafcast
EMULATED := $(if $(CROSS),$B/emulated/bin/leafcast)
# Below tests/ a file is a program that is named for it, or what programs share. Names are unique.
TESTS_C  := $(sort $(wildcard tests/*/*.c tests/*/*/*.c))
sources   = $(foreach f,$(TESTS_C),$(if $(filter $1_%,$(notdir $f)),$f))
SUPPORT  := $(filter-out $(foreach p,test tool fuzz,$(call sources,$p)),$(TESTS_C))
SUPPORT  := $(if $(X86),$(SUPPORT),$(filter-out %_sse42.c %_avx2.c %_avx512.c,$(SUPPORT)))
AIDS     := $B/app/libsupport.a
programs  = $(patsubst %.c,$B/tests/%,$(notdir $(call sources,$1)))
TESTS    := $(call programs,test)
TOOLS    := $(call programs,tool)
FUZZERS  := $(if $(filter fuzz,$(CONFIG)),$(call programs,fuzz))
CLI      := $(sort $(wildcard tests/cli/*.sh))

# A test says what it is in a line of its own, `marks: threads` (it starts threads: run under
# CONFIG=thread), `long` (it takes long: begun first, left out by `make quick`), `plain` (it holds numbers
# against numbers, or words, on input that other tests read, too: left out under CONFIG=sanitize), `bits`
# (what it says could differ on another CPU: run under CROSS), `leaks` (a script, whose processes are to
# leave no memory behind: scripts/run-tests; programs look for that in any case), or several.
names  = $(basename $(notdir $1))
marked = $(call names,$(shell grep -lE '^[^ ]+ marks:.*\b$1\b' $(call sources,test) $(CLI)))
LONG  := $(call marked,long)
QUICK  = $(filter-out $(LONG),$(call names,$(TESTS) $(CLI)))

# T="NAME..." runs only the tests of those names: make test T="test_pool front_door"
T_thread   = $(call marked,threads)
T_cross    = $(call marked,bits)
T_sanitize = $(filter-out $(call marked,plain),$(call names,$(TESTS) $(CLI)))
# SHARE=N: only every Nth, from the one DRAWN by the commit.
SHARE     ?= 1
DRAWN     ?= $(shell echo $$((0x0$$(git rev-parse --short=7 HEAD 2>/dev/null) % $(SHARE))))
shared     = $(if $(filter 1,$(SHARE)),$1,$(shell printf '%s\n' $1 | awk 'NR % $(SHARE) == $(DRAWN)'))
T         ?= $(T_$(if $(CROSS),cross,$(CONFIG)))
only = $(filter $(foreach t,$1,$B/tests/$t tests/cli/$t.sh),$2)
ASKED := $(if $(strip $T),$(call only,$T,$(TESTS) $(CLI)),$(TESTS) $(CLI))
ASKED := $(call shared,$(ASKED))
RUN   := $(call only,$(LONG),$(ASKED))
RUN   += $(filter-out $(RUN),$(ASKED))

# ---- libraries -----------------------------------------------------------------------------------
# What the library for others needs, and what the verbs need besides. bzip2 has no module there.
DOOR_LIBS := -lbz2 -lm
DOOR_PC := zlib libzstd liblzma liblz4 jansson libxxhash expat
LIBS_PC := $(DOOR_PC) libpng freetype2
ifneq ($(filter-out list help clean setup test demo,$(or $(MAKECMDGOALS),all)),)
MISSING := $(if $(shell command -v pkg-config),,pkg-config) \
           $(foreach p,$(LIBS_PC),$(shell $(PKG_CONFIG) --exists $p 2>/dev/null || echo $p))
ifneq ($(strip $(MISSING)),)
$(info leafcast needs what is not here: $(strip $(MISSING)))
$(shell scripts/setup-debian --list >&2)
$(error run scripts/setup-debian, which installs it on Debian; `make demo` and `make test` do so)
endif
DEPS_CFLAGS := $(shell $(PKG_CONFIG) --cflags $(LIBS_PC))
DEPS_LIBS   := $(shell $(PKG_CONFIG) --libs $(LIBS_PC))
IMAGE       := $B/libexec/leafcast-write-image
TETGEN_BIN  := $B/libexec/leafcast-tetgen
# Optional ones are looked for as scripts/setup-debian does; `make EMBREE= TETGEN= OIIO=` does without.
has          = $(shell scripts/setup-debian --has $1 && echo y)
CXX_HERE    := $(shell command -v $(firstword $(CXX)))
ifeq ($(CROSS),)
EMBREE      := $(call has,libembree-dev)
TETGEN      := $(if $(CXX_HERE),$(call has,libtet1.5-dev))
OIIO        := $(if $(CXX_HERE),$(call has,libopenimageio-dev))
# What importers are compiled and linked with; empty: left out. `make LIB_vdb=` does without, too.
# import-vdb counts what C++ allocates by an operator new of its own, which the sanitizers' does not go with.
LIB_vdb     := $(if $(filter sanitize thread fuzz,$(CONFIG)),,$(if $(CXX_HERE),$(if $(and $(call has,libopenvdb-dev),$(call has,libboost-dev)),-lopenvdb -ltbb $(shell $(PKG_CONFIG) --libs Imath))))
LIB_images  := $(if $(OIIO),$(shell $(PKG_CONFIG) --cflags --libs OpenImageIO))
# DCMTK has no decoder of JPEG 2000.
LIB_j2k     := $(if $(call has,libopenjp2-7-dev),-DDICOM_J2K $(shell $(PKG_CONFIG) --cflags --libs libopenjp2))
LIB_dicom   := $(if $(CXX_HERE),$(if $(call has,libdcmtk-dev),-ldcmjpeg -lijg8 -lijg12 -lijg16 -ldcmjpls -ldcmtkcharls -ldcmimgle -ldcmdata -loflog -lofstd $(LIB_j2k)))
LIB_view    := $(if $(and $(call has,libwebsockets-dev),$(call has,libturbojpeg0-dev)),$(shell $(PKG_CONFIG) --libs libwebsockets libturbojpeg))
LIB_hdf5    := $(if $(call has,libhdf5-dev),$(shell $(PKG_CONFIG) --cflags --libs hdf5-serial))
# netCDF-4 is HDF5 below, which is looked at before libnetcdf is.
LIB_netcdf  := $(if $(LIB_hdf5),$(if $(call has,libnetcdf-dev),$(shell $(PKG_CONFIG) --cflags --libs netcdf) $(LIB_hdf5)))
# CGNS is HDF5 or ADF; its library brings no .pc file.
LIB_cgns    := $(if $(LIB_hdf5),$(if $(call has,libcgns-dev),-lcgns $(LIB_hdf5)))
# Exodus is netCDF.
LIB_exodus  := $(LIB_netcdf)
ALSO_netcdf := $(addprefix prep/import/hdf5/,hdf5_chunks.c hdf5_lzf.c hdf5_storage.c hdf5_text.c hdf5_walk.c)
ALSO_cgns   := prep/import/netcdf/netcdf_storage.c $(ALSO_netcdf)
ALSO_exodus := $(filter-out %_main.c,$(wildcard prep/import/netcdf/*.c)) $(ALSO_netcdf)
endif
endif

# ---- building ------------------------------------------------------------------------------------
.DELETE_ON_ERROR:
.SECONDARY:
.PHONY: all tests test-objects run-tests quick mutants fuzz run-fuzz test stress demo setup bench check install list help clean FORCE

Q   := $(if $(V),,@)
say  = $(if $(V),,@echo "  $1  $2")
link = $(Q)$(CC) $(ALL_C) $(PLACE) $(LDFLAGS) -o $@ $(filter %.o,$^) $(filter %.a,$^) $(ALL_LIBS)

all: $(if $(filter release,$(CONFIG)),$(STATIC) $(SHARED)) $(VERBS) $(IMPORTERS) $(LEFT_OUT) $(if $(LIB_view),,without-view) $(IMAGE) $(TETGEN_BIN) $(FRONT) $(if $(filter build/release,$B),build/leafcast) $(FUZZERS)

# What make cannot see (the flags, the list of objects) lies in files that change only when their
# content does.
quoted   = '$(subst ','\'',$1)'
remember = @mkdir -p $(@D); printf '%s\n' $(call quoted,$1) | cmp -s - $@ || \
               printf '%s\n' $(call quoted,$1) >$@
$B/flags: FORCE
	$(call remember,$(CC) $(ALL_C))
$B/flags-c++: FORCE
	$(call remember,$(CXX) $(ALL_CXX))
$B/objects: FORCE
	$(call remember,$(PARTS) $(SUPPORT:%.c=$B/obj/%.o))

# One translation unit per ISA: only these may hold its instructions (scripts/check_isa).
# Vectors wider than the ISA's never leave their unit, so how they would be passed is no matter.
BITS := -mbmi -mbmi2 -mlzcnt -mpopcnt
$B/obj/%_sse42.o:  ISA := -msse4.2 -mpopcnt -Wno-psabi
$B/obj/%_avx2.o:   ISA := -mavx2 $(BITS)
$B/obj/%_avx512.o: ISA := -mavx512f -mavx512dq -mavx512bw -mavx512vl -mavx512cd $(BITS)

# Plain C in the place of vectors takes compilers longest. What it computes the units of an ISA compute, too.
$B/obj/%_wide.o:   ISA := -Wno-psabi -O1 -g0 $(if $(findstring undefined,$(FLAGS_$(CONFIG))),-fno-sanitize=undefined)
$B/obj/tests/render/mesh/test_isopolygon.o $B/obj/tests/render/triangle/test_triangle_lanes.o: ISA := -Wno-psabi

$B/obj/%.o: %.c $B/flags
	@mkdir -p $(@D)
	$(call say,CC  ,$<)
	$(Q)$(CC) $(ALL_C) $(ISA) $(IMPORT) $(if $(filter tests/%,$<),,$(FRAMES)) -MMD -MP -c -o $@ $<
$B/obj/%.o: %.cpp $B/flags-c++
	@mkdir -p $(@D)
	$(call say,C++ ,$<)
	$(Q)$(CXX) $(ALL_CXX) $(IMPORT) -MMD -MP -c -o $@ $<

define archive_rule
$1: $(patsubst %.c,$B/obj/%.o,$2) $B/objects
	@mkdir -p $$(@D) && rm -f $$@
	$$(call say,AR  ,$$@)
	$(Q)$(AR) rcsD $$@ $$(filter %.o,$$^)
endef
$(eval $(call archive_rule,$(AIDS),$(SUPPORT)))
$(eval $(call archive_rule,$(APP),$(filter render/app/% $(VIEW_PURE),$(PARTS))))
$(eval $(call archive_rule,$(VIEW),$(filter-out $(VIEW_PURE),$(filter render/view/%,$(PARTS)))))
$(eval $(call archive_rule,$(BENCH),$(filter render/bench/%,$(PARTS))))
$(eval $(call archive_rule,$(INTERNAL),$(filter-out render/app/% render/bench/% render/view/%,$(PARTS))))

# The public functions and what they reach, as one object in which nothing else has a name to the outside.
$B/app/leafcast.o: $(DOOR) $(INTERNAL)
	$(Q)$(LD) -r -o $@ $^ && $(OBJCOPY) --localize-hidden $@
$(STATIC): $B/app/leafcast.o
	@mkdir -p $(@D) && rm -f $@
	$(call say,AR  ,$@)
	$(Q)$(AR) rcsD $@ $<
$(SHARED): $B/app/leafcast.o scripts/leafcast.map
	@mkdir -p $(@D)
	$(call say,LINK,$@)
	$(Q)$(CC) $(ALL_C) -shared -Wl,-soname,$(SONAME) -Wl,--version-script,scripts/leafcast.map \
	    -Wl,-z,defs $(LDFLAGS) -o $@ $< $(shell $(PKG_CONFIG) --libs $(DOOR_PC)) $(DOOR_LIBS)
	@ln -sfn $(notdir $@) $(@D)/$(SONAME) && ln -sfn $(SONAME) $(@D)/libleafcast.so

define verb_rule
$(call verb,$1): $B/obj/$(1:.c=.o) $(if $(filter $(VIEW_C),$1),$(VIEW)) $(ARCHIVES)
	@mkdir -p $$(@D)
	$$(call say,LINK,$$@)
	$$(link)
endef
$(foreach m,$(MAINS),$(eval $(call verb_rule,$m)))

# The page is packed into the program; a list of its files is made of the folder.
$(call verb,$(VIEW_C)): ALL_LIBS += $(LIB_view)
$B/page-files: FORCE
	@mkdir -p $(@D); n=0; for f in $(notdir $(PAGE)); do n=$$((n + 1)); echo "PAGE($$n, \"$$f\")"; done >$@.new
	@cmp -s $@.new $@ && rm $@.new || mv $@.new $@
$B/obj/render/view/view_page.o: $B/page-files $(PAGE)
$B/obj/render/view/view_page.o: IMPORT := -DVIEW_PAGE_FILES='"$B/page-files"'
.PHONY: without-view
without-view:
	@rm -f $(call verb,$(VIEW_C))
	@echo "leafcast view is left out: libwebsockets or libturbojpeg is not here (scripts/setup-debian --list)"

# Shared objects by the hundred: OpenImageIO is linked into a process of its own.
ifneq ($(OIIO),)
$B/libexec/leafcast-write-image: render/app/write_image_main.cpp $B/flags-c++
	@mkdir -p $(@D) $B/obj/$(<D)
	$(call say,C++ ,$<)
	$(Q)$(CXX) $(ALL_CXX) $(shell $(PKG_CONFIG) --cflags OpenImageIO) -MMD -MP -MF $B/obj/$(<:.cpp=.d) \
	    -o $@ $< $(LDFLAGS) $(shell $(PKG_CONFIG) --libs OpenImageIO)
else
.PHONY: $B/libexec/leafcast-write-image
$B/libexec/leafcast-write-image:
	@rm -f $@
	@echo "no OpenImageIO here (libopenimageio-dev and $(CXX)): leafcast-write-image is left out," \
	      "so render writes PNG, PPM and PFM, but no EXR"
endif

# TetGen is AGPL, and may crash: it is linked into a process of its own, too.
ifneq ($(TETGEN),)
$(TETGEN_BIN): prep/tetrahedralize/tetgen_worker_main.cpp $B/flags-c++
	@mkdir -p $(@D) $B/obj/$(<D)
	$(call say,C++ ,$<)
	$(Q)$(CXX) $(ALL_CXX) -MMD -MP -MF $B/obj/$(<:.cpp=.d) -o $@ $< $(LDFLAGS) -ltet
else
.PHONY: $(TETGEN_BIN)
$(TETGEN_BIN):
	@rm -f $@ $(call verb,$(TETGEN_C))
	@echo "no TetGen here (libtet1.5-dev and $(CXX)): leafcast tetrahedralize is left out"
endif

# C++ only where the library is; linked as C++ is. A folder whose library is not here leaves nothing behind.
define importer_rule
$B/libexec/leafcast-import-$1: $(patsubst %,$B/obj/%.o,$(basename $(wildcard prep/import/$1/*.c prep/import/$1/*.cpp) $(ALSO_$1))) $(IN_PLACE_O) $(INTERNAL)
	@mkdir -p $$(@D)
	$$(call say,LINK,$$@)
	$(Q)$(if $(wildcard prep/import/$1/*.cpp),$(CXX),$(CC)) $(COMMON) $(PLACE) $(LDFLAGS) -o $$@ $$(filter %.o,$$^) \
	    $$(filter %.a,$$^) $(filter-out -I% -D%,$(LIB_$1)) $(ALL_LIBS)
$B/obj/prep/import/$1/%.o: IMPORT := $(filter -I% -D%,$(LIB_$1))
endef
$(foreach x,$(IMPORTS),$(if $(LIB_$x),$(eval $(call importer_rule,$x))))
$B/obj/prep/import/import_calls.o: IMPORT := $(if $(WATCHED),-DIMPORT_UNFENCED)
LEFT_OUT = $(foreach x,$(IMPORTS),$(if $(LIB_$x),,$B/libexec/leafcast-import-$x))
.PHONY: $(LEFT_OUT)
$(LEFT_OUT):
	@rm -f $@
	@echo "leafcast $(@:$B/libexec/leafcast-%=%) is left out: its library is not here (scripts/setup-debian --list)"

# Tables of measurements say what was measured.
COMMIT := $(shell git describe --always --dirty=+ --exclude='*' 2>/dev/null)
$B/commit: FORCE
	$(call remember,$(COMMIT))
$B/obj/render/bench/%_main.o: ISA := -DBENCH_COMMIT='"$(COMMIT)"'
$(patsubst %.c,$B/obj/%.o,$(filter render/bench/%,$(MAINS))): $B/commit

PEERS    := $(call verb,render/bench/bench_peers_main.c)
PEER_VTK := $B/libexec/leafcast-peer-vtk
# Embree is linked into the peers' benchmark alone, which is made for this machine: a peer runs as
# fast as it can, and its numbers need not be the same elsewhere.
$B/native/embree: FORCE
	$(call remember,$(EMBREE))
$B/native/%.o: %.c $B/flags $B/native/embree
	@mkdir -p $(@D)
	$(call say,CC  ,$<)
	$(Q)$(CC) $(ALL_C) $(if $(CROSS),,-march=native) -ffp-contract=fast $(if $(EMBREE),-DPEER_WITH_EMBREE) \
	    -MMD -MP -c -o $@ $<
$(PEERS): $(NATIVE:%.c=$B/native/%.o) | $(PEER_VTK)
$(PEERS): ALL_LIBS += $(if $(EMBREE),-lembree3)

$(PEER_VTK): scripts/peer_vtk
	@mkdir -p $(@D)
	@install -m 755 $< $@

$(FRONT): scripts/leafcast render/leafcast.h Makefile
	@mkdir -p $(@D)
	@sed 's/@VERSION@/$(VERSION)/' $< >$@ && chmod 755 $@
build/leafcast: $(FRONT)
	@ln -sfn release/bin/leafcast $@
# A front door whose verbs are scripts that begin the emulator.
$B/emulated/bin/leafcast: $(FRONT) $(VERBS)
	@rm -rf $B/emulated && mkdir -p $(@D) $B/emulated/libexec
	@for verb in $(notdir $(VERBS)); do \
	    printf '#!/bin/sh\nexec %s "$$@"\n' "$(RUNNER) $(CURDIR)/$B/libexec/$$verb" >$B/emulated/libexec/$$verb; \
	done
	@chmod 755 $B/emulated/libexec/*
	@cp -p $< $@

# ---- tests ---------------------------------------------------------------------------------------
$(TESTS) $(TOOLS): LINK_TESTS := -lcmocka
$(FUZZERS): LINK_TESTS := -fsanitize=fuzzer -lcmocka
# What importers parse themselves, without their libraries.
$B/tests/fuzz_image: $(patsubst %,$B/obj/prep/import/images/%.o,geotiff jpeg_end tiff_pages tiff_pieces tiff_place)
$B/tests/fuzz_import: $(patsubst %,$B/obj/prep/import/%.o,packed_samples netcdf/netcdf_header dicom/dicom_order images/image_names)
define program_rule
$B/tests/$(basename $(notdir $1)): $B/obj/$(1:.c=.o) $(AIDS) $(ARCHIVES)
	@mkdir -p $$(@D)
	$$(call say,LINK,$$@)
	$$(link) $$(LINK_TESTS)
endef
$(foreach p,test tool fuzz,$(foreach f,$(call sources,$p),$(eval $(call program_rule,$f))))

# Fenced as importers are.
$B/tests/tool_importer: $(IN_PLACE_O)

$B/flags-link: FORCE
	$(call remember,$(PLACE) $(LDFLAGS) $(DEPS_LIBS))
$(SHARED) $(VERBS) $(IMPORTERS) $(IMAGE) $(TETGEN_BIN) $(TESTS) $(TOOLS) $(FUZZERS): $B/flags-link

# Files of a library's own making, and what it reads of them.
TOOL_VDB = $(if $(LIB_vdb),$B/tests/tool_vdb)
$B/tests/tool_vdb: tests/tools/tool_vdb.cpp $B/flags-c++
	@mkdir -p $(@D) $B/obj/$(<D)
	$(call say,C++ ,$<)
	$(Q)$(CXX) $(filter-out -fvisibility=hidden,$(ALL_CXX)) -O0 -Wno-deprecated-declarations -MMD -MP \
	    -MF $B/obj/$(<:.cpp=.d) -o $@ $< $(LDFLAGS) $(LIB_vdb)

tests: all $(TESTS) $(TOOLS) $(TOOL_VDB)
# What tests are made of, and no more: with CFLAGS=-fsyntax-only, what a compiler says of it.
test-objects: $(patsubst %.c,$B/obj/%.o,$(call sources,test) $(call sources,tool) $(SUPPORT))
TEST_ENV = LEAFCAST_BUILD=$(CURDIR)/$B LEAFCAST=$(CURDIR)/$(or $(EMULATED),$(FRONT)) \
           LEAFCAST_COMPILE=$(call quoted,$(CC) $(ALL_C)) LEAFCAST_LIBS='$(ALL_LIBS) -lcmocka'
run-tests: all $(EMULATED) $(if $(CROSS),,$(TOOLS) $(TOOL_VDB)) $(filter $B/%,$(RUN))
	@$(TEST_ENV) scripts/run-tests --timeout $(TIMEOUT) $(if $(RUNNER),--under $(call quoted,$(RUNNER))) $(RUN)
quick:
	@scripts/check_layers
	@scripts/check_kinds
	@scripts/check_headers
	@scripts/check_size
	@$(MAKE) --no-print-directory $(ALL_CORES) run-tests T="$(QUICK)"
# All that tests/cli/mutants.sh takes samples of; T="PART..." only those with this in their names.
mutants: all $(TESTS)
	@$(TEST_ENV) scripts/run-mutants $(foreach t,$T,$(call quoted,$t))

# All fuzz targets from their corpora, or T="NAME..."; clang's sanitizers watch.
FUZZ ?= 60
fuzz:
	@$(MAKE) --no-print-directory $(ALL_CORES) CONFIG=fuzz run-fuzz
run-fuzz: $(if $(strip $T),$(call only,$T,$(FUZZERS)),$(FUZZERS))
	@scripts/run-fuzz $(FUZZ) $^

# The stress lab at length, COUNT ray-cells of each case; its short form is in `make test`.
COUNT ?= 5000000
stress: all $B/tests/tool_stress
	$B/tests/tool_stress --count $(COUNT) $(if $(CSV),--csv $(CSV))

# These two need nothing but make and a compiler: libraries are looked for after the set-up. Without
# a -j of the caller's they take all cores.
ALL_CORES = $(if $(findstring -j,$(MAKEFLAGS)),,-j$(shell nproc))
test: setup
	@$(MAKE) --no-print-directory $(ALL_CORES) run-tests
demo: setup
	@$(MAKE) --no-print-directory $(ALL_CORES) all
	@LEAFCAST=$(FRONT) scripts/demo
setup:
	@scripts/setup-debian
bench: all
	$(FRONT) bench $(SUITE)

# What editors and clang-tidy ask for, of this CONFIG and CC.
compile_commands.json: FORCE
	@$(MAKE) --no-print-directory -Bn V=1 tests 2>/dev/null | awk -v folder="$(CURDIR)" ' \
	    BEGIN { print "[" } END { print "\n]" } \
	    / -c -o / { file = $$NF; gsub(/\\/, "\\\\"); gsub(/"/, "\\\""); \
	        printf "%s{\"directory\": \"%s\", \"file\": \"%s\", \"command\": \"%s\"}", \
	            n++ ? ",\n" : "", folder, file, $$0 }' >$@

check: all
	scripts/check_layers
	scripts/check_kinds
	scripts/check_headers
	scripts/check_isa $B
	scripts/check_man $B
	scripts/check_size
	scripts/check_format

# ---- installing ----------------------------------------------------------------------------------
D := $(DESTDIR)$(PREFIX)
install: all $(STATIC) $(SHARED)
	install -d $D/bin $D/libexec/leafcast $D/lib/pkgconfig $D/include/leafcast $D/share/man/man1 $D/share/man/man5
	install -m 755 $(FRONT) $D/bin
	install -m 755 $(VERBS) $(IMPORTERS) $(PEER_VTK) $(if $(OIIO),$(IMAGE)) $(if $(TETGEN),$(TETGEN_BIN)) \
	    $D/libexec/leafcast
	install -m 644 $(STATIC) $(SHARED) $D/lib
	ln -sfn $(notdir $(SHARED)) $D/lib/$(SONAME)
	ln -sfn $(SONAME) $D/lib/libleafcast.so
	install -m 644 $(HEADERS) $D/include/leafcast
	install -m 644 $(wildcard scripts/man/*.1) $D/share/man/man1
	install -m 644 $(wildcard scripts/man/*.5) $D/share/man/man5
	install -D -m 644 scripts/completion.bash $D/share/bash-completion/completions/leafcast
	install -D -m 644 scripts/completion.zsh $D/share/zsh/site-functions/_leafcast
	sed 's|@PREFIX@|$(PREFIX)|; s|@VERSION@|$(VERSION)|; s|@REQUIRES@|$(DOOR_PC)|' \
	    scripts/leafcast.pc.in >$D/lib/pkgconfig/leafcast.pc

list help:
	@echo "make            build everything into $B (and build/leafcast)"
	@echo "make test       install what is missing, build, run all tests; T=\"NAME...\" for some"
	@echo "make quick      rules of the house and all tests but the long ones, in a minute"
	@echo "make mutants    all wrong kernels, of which make test takes a sample; T=\"PART...\" for some"
	@echo "make fuzz       hostile files, FUZZ=$(FUZZ) seconds for each fuzz target, with clang; T=\"NAME...\" for some"
	@echo "make stress     ray-cells by the million against the reference; COUNT=$(COUNT) CSV=FILE"
	@echo "make demo       install what is missing, build, generate, convert, render: demo.png"
	@echo "make bench      the benchmark tables; SUITE=NAME for one"
	@echo "make check      the rules of the house: layers, kinds, headers, ISA, manual, sizes, format"
	@echo "make compile_commands.json   for editors"
	@echo "make install    PREFIX=$(PREFIX) DESTDIR=$(DESTDIR)"
	@echo "make setup      install what is missing (Debian)"
	@echo "make clean      remove build/ and demo.png"
	@echo
	@echo "CONFIG=$(CONFIG)  one of $(CONFIGS); each has its own folder in build/"
	@echo "CC=$(CC) CXX=$(CXX) CPPFLAGS= CFLAGS= CXXFLAGS= LDFLAGS="
	@echo "WERROR=1        warnings are errors"
	@echo "CROSS=aarch64-linux-gnu   build for another machine; its tests are begun by RUNNER=$(or $(RUNNER),qemu-aarch64-static)"
	@echo "EMBREE= TETGEN= OIIO= LIB_vdb= LIB_..=   build without one, though it is here"
	@echo "SHARE=N         only every Nth script of tests/cli, others with each commit"
	@echo "TIMEOUT=$(TIMEOUT)     seconds a test program may take"
	@echo "V=1             show the commands"

clean:
	rm -rf build demo.png

# As deep as their sources.
-include $(shell find $B/obj $B/native -mindepth 2 -name '*.d' 2>/dev/null)
