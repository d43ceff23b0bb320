# pipelines/dynamic.mk -- frames of a segment in which something moves: what stands is computed once, of a frame what movers change.
# Included by Makefile.example, whose rules make all other frames; dynamic.md is its page. plan.mk (formats/plan/plan.md) has the states of
# light that follow from a segment (stands_F names it), the segment's state files (state_S), and how far they follow (plan_moving).
STAGES  += stands
updated  = $(foreach f,$(plan_photons),$(if $(stands_$f),$f))
segments = $(sort $(foreach f,$(updated),$(stands_$f)))
members  = $(foreach f,$(updated),$(if $(filter $1,$(stands_$f)),$f))#  states of light of a segment
looked   = $(sort $(foreach f,$(call members,$1),$(views_$f)))#         pictures that they light
aimed    = $(sort $(foreach f,$(call members,$1),$(view_$f)))#          where their photons are aimed: one file or none
# Dynamic photons of up to two states before one, in the same segment: where they mattered, records are gathered still.
earlier  = $(sort $(filter-out $1,$(foreach p,$(previous_$1) $(previous_$(previous_$1)),$(if $(filter $(stands_$1),$(stands_$(photons_$p))),$(photons_$p)))))
frames_of = $$(echo $1 | tr ' ' ,)
spent_on_segment = $(OUT)/stands/$1.json+$(OUT)/stands/$1_points.json+$(if $(filter records,$(plan_moving)),$(OUT)/stands/$1_cache.json+)
$(if $(segments),$(shell mkdir -p $(OUT)/stands))

# What stands, once for a segment: its light, which of its paths of light movers can touch, its points and records.
$(segments:%=$(OUT)/stands/%.photons): $(OUT)/stands/%.photons: $$(state_$$*) $$(call aimed,$$*) $(OUT)/options/photons $(BIN)/photon-trace
	$(RUN) $(BIN)/photon-trace $(SCENE) --frame $* --map static $(addprefix --importance ,$(call aimed,$*)) $(options_photons) -o $@ \
	  --paths $(@:.photons=.paths) --stats $(@:.photons=.json)
$(segments:%=$(OUT)/stands/%.irradpoints): $(OUT)/stands/%.irradpoints: $(OUT)/stands/%.photons $$(call aimed,$$*) $(OUT)/options/points $(BIN)/irradcache-build
	$(RUN) $(BIN)/irradcache-build points $(SCENE) --frame $* --map static --photons $< $(addprefix --importance ,$(call aimed,$*)) $(options_points) -o $@ --stats $(@:.irradpoints=_points.json)
$(segments:%=$(OUT)/stands/%.irradcache): $(OUT)/stands/%.irradcache: $(OUT)/stands/%.irradpoints $(OUT)/options/cache \
  $$(foreach f,$$(call looked,$$*),$$(camera_$$f))
	$(RUN) $(BIN)/irradcache-build records $(SCENE) --frames $(call frames_of,$(call looked,$*)) --map static --points $< $(options_cache) -o $@ \
	  --stats $(@:.irradcache=_cache.json)

# A state of light: what movers change of the photons, points made from those of what stands.
$(updated:%=$(OUT)/photons/%.photons): $(OUT)/photons/%.photons: $$(light_$$*) $(OUT)/stands/$$(stands_$$*).photons
	$(RUN) $(BIN)/photon-trace $(SCENE) --frame $* --map dynamic --static $(OUT)/stands/$(stands_$*).paths \
	  $(addprefix --importance ,$(view_$*)) $(shared) -o $@ --stats $(@:.photons=.json)
$(updated:%=$(OUT)/points/%.irradpoints): $(OUT)/points/%.irradpoints: $(OUT)/photons/%.photons $(OUT)/stands/$$(stands_$$*).irradpoints
	$(RUN) $(BIN)/irradcache-build points $(SCENE) --frame $* --update $(OUT)/stands/$(stands_$*).irradpoints \
	  --photons $(OUT)/stands/$(stands_$*).photons --dynamic $< $(addprefix --importance ,$(view_$*)) $(options_points) -o $@ --stats $(@:.irradpoints=.json)
ifeq ($(plan_moving),records)
updated_records = $(updated:%=$(OUT)/cache/%.irradcache)
$(updated_records): $(OUT)/cache/%.irradcache: $(OUT)/points/%.irradpoints $(OUT)/stands/$$(stands_$$*).irradcache \
  $$(foreach f,$$(call earlier,$$*),$(OUT)/photons/$$f.photons)
	$(RUN) $(BIN)/irradcache-build records $(SCENE) --frames $(call frames_of,$(views_$*)) --update $(OUT)/stands/$(stands_$*).irradcache \
	  --points $< $(patsubst %,--dynamic $(OUT)/photons/%.photons,$* $(call earlier,$*)) $(options_cache) -o $@ --stats $(@:.irradcache=.json)
endif
