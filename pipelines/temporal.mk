# pipelines/temporal.mk -- MOVING=time: light as with MOVING=light; records keep their incoming light from frame to frame.
# Included by Makefile.example after dynamic.mk; temporal.md is its page. A frame follows from the one before it in its segment, so the
# frames of a segment are made one after the other, segments side by side.
STAGES   += kept
# States of light that are one picture's alone: where a camera moves while the light stands, one cache serves all its pictures.
over_time = $(foreach f,$(updated),$(if $(word 2,$(views_$f)),,$f))
kept_from = $(foreach p,$(filter $(over_time),$(photons_$(previous_$1))),$(if $(filter $(stands_$1),$(stands_$p)),$p))
updated_records = $(over_time:%=$(OUT)/cache/%.irradcache)
$(if $(over_time),$(shell mkdir -p $(OUT)/kept))
.PRECIOUS: $(OUT)/kept/%.radsamples

$(OUT)/cache/%.irradcache $(OUT)/kept/%.radsamples: $(OUT)/points/%.irradpoints $$(foreach p,$$(call kept_from,$$*),$(OUT)/kept/$$p.radsamples) \
  $$(camera_$$*) $(OUT)/options/cache $(BIN)/gather-temporal
	$(RUN) $(BIN)/gather-temporal final $(SCENE) --frame $* --points $< $(patsubst %,--previous $(OUT)/kept/%.radsamples,$(call kept_from,$*)) \
	  $(options_cache) -o $(OUT)/kept/$*.radsamples --cache $(OUT)/cache/$*.irradcache --stats $(OUT)/cache/$*.json
