# pipelines/split.mk -- bright points are divided from the others and sampled explicitly, as lamps are; split.md is its page.
# Included by Makefile.example where plan.mk has plan_split, which it has not where records follow from those of what stands.
STAGES += split
split_stage = split
$(shell mkdir -p $(OUT)/split)
.PRECIOUS: $(OUT)/split/%.low.irradpoints $(OUT)/split/%.high.irradpoints

$(OUT)/split/%.low.irradpoints $(OUT)/split/%.high.irradpoints: $(OUT)/points/%.irradpoints $(BIN)/photonmap-split
	$(RUN) $(BIN)/photonmap-split $< --low $(OUT)/split/$*.low.irradpoints --high $(OUT)/split/$*.high.irradpoints --stats $(OUT)/split/$*.json

# Records hold both parts; without records pixels sample the high part themselves.
ifeq ($(plan_indirect),records)
split_records = $(filter-out $(updated_records),$(cache))# those over time are temporal.mk's
$(split_records): $(OUT)/cache/%.irradcache: $(OUT)/split/%.low.irradpoints $(OUT)/split/%.high.irradpoints \
  $$(foreach f,$$(views_$$*),$$(camera_$$f)) $(OUT)/options/cache $(BIN)/irradcache-build
	$(RUN) $(BIN)/irradcache-build records $(SCENE) --frames $$(echo $(views_$*) | tr ' ' ,) --points $< --high $(word 2,$^) $(options_cache) \
	  -o $@ --stats $(@:.irradcache=.json)
else
split_points = $(OUT)/split/$1.low.irradpoints --high $(OUT)/split/$1.high.irradpoints
endif
