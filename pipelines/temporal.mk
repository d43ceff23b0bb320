# pipelines/temporal.mk -- MOVING=time: light as with MOVING=light; records keep their incoming light from frame to frame.
# Included by Makefile.example after dynamic.mk; temporal.md is its page. A frame follows from the one before it in its segment, so the
# frames of a segment are made one after the other, segments side by side.
STAGES   += kept
# States of light that are one picture's alone: where a camera moves while the light stands, one cache serves all its pictures.
over_time = $(foreach f,$(updated),$(if $(word 2,$(views_$f)),,$f))
kept_from = $(foreach p,$(filter $(over_time),$(photons_$(previous_$1))),$(if $(filter $(stands_$1),$(stands_$p)),$p))
updated_records = $(over_time:%=$(OUT)/cache/%.irradcache)
$(if $(over_time),$(shell mkdir -p $(OUT)/kept))
# All of the light, or where bright points are divided from the others its two parts (split.mk).
points_of_time = $(if $(plan_split),$(OUT)/split/$1.low.irradpoints $(OUT)/split/$1.high.irradpoints,$(OUT)/points/$1.irradpoints)

# A rule for each by name: make does not use one pattern rule twice in a chain, and a frame follows from the one before it.
define kept_rule
$(OUT)/cache/$1.irradcache $(OUT)/kept/$1.radsamples &: $(call points_of_time,$1) $(patsubst %,$(OUT)/kept/%.radsamples,$(call kept_from,$1)) \
  $(camera_$1) $(OUT)/options/cache $(BIN)/gather-temporal
	$$(RUN) $(BIN)/gather-temporal final $$(SCENE) --frame $1 --points $$< $(addprefix --high ,$(word 2,$(call points_of_time,$1))) $(patsubst %,--previous $(OUT)/kept/%.radsamples,$(call kept_from,$1)) \
	  $$(options_cache) -o $(OUT)/kept/$1.radsamples --cache $(OUT)/cache/$1.irradcache --stats $(OUT)/cache/$1.json
endef
$(foreach f,$(over_time),$(eval $(call kept_rule,$f)))

# For `make report`: rays, ages, records born and removed, frame by frame.
kept_report = $(if $(over_time),$(OUT)/report/over-time.md)
$(OUT)/report/over-time.md: $(updated_records) $(pipelines)temporal_report.awk
	awk -f $(filter %.awk,$^) $(updated_records:.irradcache=.json) > $@
